#!/bin/sh
# tests/compare/run.sh - circuits by the library of another commit and by the present one, in turns: instructions, and
# whether the results are the same to the last bit.
#
#     tests/compare/run.sh COMMIT [CIRCUIT...]
#
# `make compare` calls it, once build/libnonsmooth.a is there.  The library of COMMIT is built in
# build/compare/COMMIT; the circuits (circuits.c) are the present ones in both.  Instructions are those of the
# process less those of one that does nothing: of perf where it may count, else of callgrind.
# A result that differs: the first value that does, and the largest difference, relative to the largest value
# that the same unknown has in the run, or to 1e-9 of the largest of all unknowns.
# Environment: CHECK=off: the present library makes no check of its results (without_check.c), as commits before src/verify did.
set -eu
cd "$(dirname "$0")/../.."
base=$(git rev-parse --short=12 "$1^{commit}")
shift
unset MAKEFLAGS MFLAGS
export OPENBLAS_NUM_THREADS=1
out=build/compare
tree=$out/$base
mkdir -p "$tree"

[ -f "$tree/Makefile" ] || git archive "$base" Makefile include src | tar -x -C "$tree"
[ -f "$tree/build/libnonsmooth.a" ] || echo "compare: building the library of $base"
make -s -C "$tree" "-j$(nproc)" CC="${CC:-gcc}" CFLAGS="${CFLAGS:--O2 -g}" build/libnonsmooth.a \
    >"$tree/make.log" 2>&1 || {
    cat "$tree/make.log"
    exit 1
}

# What these name and older headers name otherwise: new=old.
renamed='NS_EXACT=NS_FLIGHT jumps_by_steps=refused input_states=waves periods=laps predicted=settled checks=predicted retries=predicted'

# program TREE NAME OPTION...: the circuits by the library of TREE.
program() {
    tree_of=$1 name=$2 names=
    shift 2
    for pair in $renamed; do
        sed 's|/\*.*||; /^ \*/d' "$tree_of"/include/nonsmooth/*.h | grep -qw "${pair%=*}" || names="$names -D$pair"
    done
    # shellcheck disable=SC2086 # options
    ${CC:-gcc} -std=c11 ${CFLAGS:--O2 -g} -ffunction-sections $names "-I$tree_of/include" -Itests/rig -Itests/bench \
        tests/compare/main.c tests/compare/circuits.c tests/bench/cases*.c tests/bench/deck.c \
        tests/bench/oracle.c tests/rig/lit*.c \
        -Wl,--gc-sections "$@" "$tree_of/build/libnonsmooth.a" -o "$out/$name" ${LIBS:--llapacke -llapack -lblas -lklu -lm}
}
program "$tree" before &
case ${CHECK:-on} in
on) program . after ;;
off) program . after @tests/compare/without_check.options ;;
*) echo "compare: CHECK=$CHECK is neither on nor off" >&2 && exit 2 ;;
esac
wait $!

if perf stat -x, -e instructions:u true 2>&1 | grep -q '^[0-9]'; then
    counter=perf
else
    counter=callgrind
fi

# count FILE PROGRAM ARGUMENT...: how many instructions it takes, into FILE.
count() {
    to=$1
    shift
    if [ $counter = perf ]; then
        perf stat -x, -e instructions:u -o "$to.log" "$@" >/dev/null
        awk -F, '/instructions/ {print $1}' "$to.log" >"$to"
    else
        valgrind --tool=callgrind --callgrind-out-file=/dev/null --log-file="$to.log" "$@" >/dev/null
        awk '/Collected/ {print $NF}' "$to.log" >"$to"
    fi
}

# both WHAT ARGUMENT...: WHAT.before and WHAT.after, side by side.
both() {
    what=$1
    shift
    count "$what.before" "$out/before" "$@" &
    count "$what.after" "$out/after" "$@"
    wait $!
}

# differences FILE FILE: what differs, in a few words.
differences() {
    awk '
        FNR == 1 {point = -1; file++}
        $1 == "t[0]" {point++; t = $2}
        {
            size = $2 < 0 ? -$2 : $2; kind = $1; sub(/\[.*/, "", kind)
            if (size > all[kind]) all[kind] = size
        }
        file == 1 {name[FNR] = $1; value[FNR] = $2; next}
        $1 != name[FNR] {print "of another shape, from line " FNR " on"; other = 1; exit}
        $2 != value[FNR] || $2 "" != value[FNR] "" {
            d = $2 - value[FNR]; d = d < 0 ? -d : d
            if ($1 ~ /^count/) counts = counts " " substr($1, 7) " " value[FNR] " -> " $2
            else if (first == "") first = sprintf("%s at t = %s: %s -> %s", $1, t, value[FNR], $2)
            if ($1 !~ /^count/ && d > most[$1]) most[$1] = d
        }
        END {
            if (other) exit
            for (n in most) {
                kind = n; sub(/\[.*/, "", kind)
                if (all[kind] > 0 && most[n] / all[kind] > worst) worst = most[n] / all[kind]
            }
            if (first != "") printf "%s; at most %.1e of the largest%s", first, worst, counts == "" ? "" : "; "
            if (counts != "") printf "counters:%s", counts
            print ""
        }' "$1" "$2"
}

both "$out/nothing" list
{
    printf 'instructions (%s) less those of an idle process; before: %s\n' $counter "$base"
    printf '%-13s %-7s %14s %14s %7s  %s\n' circuit engine before after ratio results
}
"$out/after" list | while read -r circuit engine; do
    [ $# = 0 ] || echo " $* " | grep -q " $circuit " || continue
    file=$out/$circuit.$engine
    status=same
    "$out/before" "$circuit" "$engine" "$file.result.before" || status='before: failed'
    "$out/after" "$circuit" "$engine" "$file.result.after" || status='after: failed'
    [ "$status" != same ] || cmp -s "$file.result.before" "$file.result.after" ||
        status="differ: $(differences "$file.result.before" "$file.result.after")"
    both "$file" "$circuit" "$engine" || true
    echo "$circuit $engine $(cat "$file.before" "$file.after" "$out/nothing.before" "$out/nothing.after" |
        tr '\n' ' ') $status"
done | awk '
    {
        before = $3 - $5; after = $4 - $6; ratio = before > 0 ? after / before : 0
        printf "%-13s %-7s %14.0f %14.0f %7.4f ", $1, $2, before, after, ratio
        for (k = 7; k <= NF; k++) printf " %s", $k
        print ""
        fflush()
        if (ratio > worst) {worst = ratio; at = $1 " " $2}
        runs++
        differ += $7 != "same"
    }
    END {printf "worst ratio %.4f (%s); results of %d of %d runs differ\n", worst, at, differ, runs}'
