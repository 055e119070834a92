#!/bin/sh
# tests/run.sh - runs all that `make test` built, prints what failed and why, and the closing count.
#
#     tests/run.sh [all | sanitize | valgrind | tags | readmes | rooms]
#
# Two sorts of tests: cmocka programs (counted by their TAP output) and scripts that print `ok NAME`,
# `FAIL NAME reason` or `skip NAME reason` for each of their tests.  A program that crashes, hangs, or runs no
# test is a failure.  Output of everything: build/log/.
set -u
cd "$(dirname "$0")/.." || exit 1
log=$PWD/build/log
export OPENBLAS_NUM_THREADS=1 # one thread a process: the matrices are small
export UBSAN_OPTIONS=print_stacktrace=1

# Writes "passed failed skipped" to FILE.count and says one line, with the reasons indented below it.
# verdict NAME FILE exit-status passed failed skipped
verdict() {
    name=$1 file=$2 status=$3 passed=$4 failed=$5 skipped=$6 why=
    if [ "$status" = 124 ]; then
        failed=$((failed + 1))
        why="still running after its time"
    elif [ "$failed" = 0 ] && [ "$status" != 0 ]; then
        failed=1
        why="exit status $status"
    elif [ $((passed + failed + skipped)) = 0 ]; then
        failed=1
        why="ran no test"
    fi
    echo "$passed $failed $skipped" >"$file.count"
    if [ "$failed" = 0 ]; then
        echo "ok    $name ($passed)"
    else
        echo "FAIL  $name ($passed passed, $failed failed) $why"
        [ -z "$why" ] || { grep -m1 -A12 'Sanitizer' "$file" || tail -n 15 "$file"; } | sed 's/^/      | /'
        # shellcheck disable=SC2016 # awk's
        awk '/^(not ok|FAIL) / && !/# SKIP/ {on = 40} /^(ok|skip) / {on = 0} on-- > 0 {print "      | " $0}' "$file"
    fi
}

count() {
    grep -c -E "$1" "$2" || true
}

# cmocka LABEL PROGRAM
cmocka() {
    name=${2#*/tests/}
    file=$log/$1.$(echo "$name" | tr / .).log
    CMOCKA_MESSAGE_OUTPUT=TAP timeout 300 "$2" >"$file" 2>&1 </dev/null
    status=$?
    skipped=$(count '^not ok .*# SKIP' "$file")
    failed=$(count '^not ok ' "$file")
    verdict "$1: $name" "$file" $status "$(count '^ok ' "$file")" $((failed - skipped)) "$skipped"
}

# script LABEL COMMAND...
script() {
    label=$1
    shift
    file=$log/$label.log
    KEEP=$log/$label.runs timeout 720 "$@" >"$file" 2>&1 </dev/null
    status=$?
    # The netlist runner prints its verdicts at its end; killed before, it leaves them there.
    [ $status != 124 ] || cat "$log/$label.runs/verdicts" >>"$file" 2>/dev/null
    verdict "$label" "$file" $status "$(count '^ok ' "$file")" "$(count '^FAIL ' "$file")" "$(count '^skip ' "$file")"
}

# programs LABEL BUILD: a line for each.
programs() {
    for program in "$2"/tests/property/* "$2"/tests/reference/* "$2"/tests/fault/* "$2"/tests/unit/*/*; do
        [ ! -x "$program" ] || echo "cmocka $1 $program"
    done
}

plain() {
    cat <<END
script netlists tests/netlist/run.sh
script host tests/host/run.sh
script waveforms env RUNS="auto squares devices" tests/waveform/run.sh
script tool tests/tool/run.sh
script source tests/source.sh
script install tests/install.sh
script tags tests/tags.sh
script readmes tests/readmes.sh
script rooms tests/rooms.sh
script fuzz tests/fuzz.sh 8
END
    programs unit build
}

# Every value of ngbehavior takes the same way through the code; the plain run has them all.
sanitize() {
    # shellcheck disable=SC2016 # the job expands it
    asan='env BEHAVIORS= NONSMOOTH_CM=build/asan/nonsmooth.cm PLAIN_NGSPICE="${NGSPICE:-ngspice}" NGSPICE="$PWD/tests/ngspice-asan.sh" tests/netlist/run.sh'
    cat <<END
script netlists-asan $asan default cases/
script errors-asan $asan errors/
script tool-asan tests/tool/run.sh build/asan/nsc-mlcp
END
    programs unit-asan build/asan
}

# What there is to run, a line each: what takes long is begun first.
jobs() {
    case $1 in
    all) sanitize && echo script valgrind tests/valgrind.sh && plain ;;
    sanitize) sanitize ;;
    valgrind | tags | readmes | rooms) echo "script $1 tests/$1.sh" ;;
    *) echo "tests/run.sh: no such part: $1" >&2 && return 2 ;;
    esac
}

if [ "${1:-}" = --job ]; then
    said=$(eval "$2") # all its lines at once
    echo "$said"
    exit
fi
jobs=$(jobs "${1:-all}") || exit
rm -rf "$log"
mkdir -p "$log"
export JOBS=1
echo "$jobs" | xargs -d '\n' -n1 -P "${AT_ONCE:-$(nproc)}" "$0" --job

# shellcheck disable=SC2046 # three numbers
set -- $(cat "$log"/*.count | awk '{p += $1; f += $2; s += $3} END {print p + 0, f + 0, s + 0}')
skipped=
[ "$3" = 0 ] || skipped=", $3 skipped"
echo "$1 passed, $2 failed$skipped"
[ "$2" = 0 ] && [ "$1" != 0 ]
