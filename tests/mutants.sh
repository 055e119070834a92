#!/bin/sh
# tests/mutants.sh - small changes to src/, one at a time: does a test notice?
#
#     tests/mutants.sh COUNT SEED
#
# `make mutants` calls it, with everything built in build/mutants, and once more with gcov's counters in
# build/mutants/lines.  COUNT mutants, picked by SEED among all candidates (tests/mutants/candidates.awk); those that do
# not compile, or to the same object by -O2, are replaced by others.  Each test (a program, or a netlist through ngspice,
# but not its repetitions in other values of ngbehavior) runs once with the counters.  For each mutant its file is
# compiled and the library linked anew.  Then the tests that execute the changed line run, until one fails: the quickest
# first, those of its room's folder as if they took a quarter of their time; then a few programs under valgrind, the
# tests of nsc-mlcp and of waveforms.  A test that takes ten times as long as it does, and 5 s, fails.  After SECONDS_EACH
# of netlists the mutant lives: more of them could only raise the rate.
# Printed, each as soon as it is known: what noticed a mutant, or that it lives, with the number of tests that execute its
# line; at the end how many were noticed.  For those of tests/mutants/accepted, lines "FILE | BEFORE | AFTER | REASON",
# the reason.  Run again with the same seed, sources and tests, it goes on where it was ended.  Status 0: 85 of 100 were
# noticed.
# Environment: QUICK=yes leaves out netlists, valgrind, and programs of more than a second; MUTANTS_IN: folders or files to
# change, in place of src; JOBS: so many side by side (number of processors); SECONDS_EACH: 120.
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C OPENBLAS_NUM_THREADS=1 TIME_LIMIT=600
dir=$PWD/build/mutants
made=$dir/made
tab=$(printf '\t')

# objects MUTANT: of the library, the mutant's in place of its original.
objects() {
    file=$(cut -f2 "$made/$1/change")
    find src -name '*.c' ! -path 'src/tool/*' ! -path "$file" | sed "s|\(.*\)\.c$|$dir/obj/\1.o|"
    case $file in src/tool/*) ;; *) echo "$made/$1/mutant.o" ;; esac
}

# compile MUTANT: mutant.o is there if it is another object.
compile() {
    at=$made/$1
    IFS=$tab read -r _ file line _ before after <"$at/change"
    copy=$at/$(basename "$file")
    AFTER=$after awk -v line="$line" '
        FNR == line {match($0, /^ */); $0 = substr($0, 1, RLENGTH) ENVIRON["AFTER"]} {print}' "$file" >"$copy"
    # shellcheck disable=SC2086 # options
    $CC $CFLAGS -iquote "$(dirname "$file")" -c "$copy" -MF /dev/null -o "$at/mutant.o" 2>/dev/null ||
        rm -f "$at/mutant.o"
    ! cmp -s "$at/mutant.o" "$dir/obj/${file%.c}.o" || rm -f "$at/mutant.o"
    rm -f "$copy"
}

# link_models FOLDER OBJECT...: the code models, and what netlists need beside them.
link_models() {
    to=$1
    shift
    # shellcheck disable=SC2086 # objects, options
    $CC -shared -Wl,--version-script=codemodels/nonsmooth.map $CM_OBJ "$@" -o "$to/nonsmooth.cm" $CM_LIBS
    ln -sf "$dir"/nonsmooth*.inc "$dir/nsc-mlcp" "$to"
}

# limited SECONDS COMMAND...: with so much CPU time.
# shellcheck disable=SC3045 # dash and bash have these
limited() (
    ulimit -t "$1"
    ulimit -v 4000000
    shift
    timeout 1200 "$@" >/dev/null 2>&1 </dev/null
)

# netlist FOLDER FILE VARIANT: runs it there with nonsmooth.cm.  NGSPICE: the program.
netlist() {
    mkdir -p "$1"
    SCRATCH=$1 tests/netlist/run.sh --one "$2" "$3"
}

# record NUMBER: the test of that line of $dir/test.list, with counters; its CPU time, in 1/100 s, or none where it fails.
record() {
    test=$(sed -n "${1}p" "$dir/test.list")
    at=$dir/runs/$1
    rm -rf "$at"
    mkdir -p "$at"
    # shellcheck disable=SC2086 # words
    (
        case $test in
        netlist*) NGSPICE=$dir/ngspice NONSMOOTH_CM=$dir/lines/nonsmooth.cm netlist "$at" ${test#netlist} ;;
        *) GCOV_PREFIX=$at LD_LIBRARY_PATH=$dir/lines "$test" ;;
        esac >"$at/out" 2>&1 </dev/null && times >"$at/times"
    )
    if [ -s "$at/times" ]; then
        awk -v n="$1" 'NR == 2 {split($1, t, /[ms]/); print n, int(100 * (60 * t[1] + t[2])) + 1}' "$at/times" >"$at/time"
    else
        echo "mutants: $test fails without any change, and is left out" >&2
        tail -n 2 "$at/out" >&2
    fi
    # Few processes: where to start one is slow, three for each file took longer than all tests.
    data=$(find "$at" -type d -path '*/obj/src' -prune)
    [ -z "$data" ] || { mv "$data" "$at/src" && cp -rs "$dir/lines/obj/src" "$at"; }
}

# executes NUMBER FILE LINE: whether that test executes the line; of one without code of its own, the line before it.
executes() {
    data=$dir/runs/$1/${2%.c}.gcda
    [ -f "$data" ] || return 1
    [ -f "$data.lines" ] || { gcov -t "$data" 2>/dev/null | awk -v file="$2" '
        / 0:Source:/ {sub(/.*0:Source:/, ""); ours = $0 == file; ran = 0; next}
        ours {
            split($0, part, ":")
            if (part[1] ~ /[0-9#]/) ran = part[1] ~ /[0-9]/
            if (substr($0, length(part[1]) + length(part[2]) + 3) ~ /^}/) ran = 0
            if (ran) print part[2] + 0
        }' >"$data.$$" && mv "$data.$$" "$data.lines"
    } # others may read it
    grep -qx "$3" "$data.lines"
}

# noticed_by MUTANT: prints what notices it, or nothing.
noticed_by() {
    at=$made/$1
    file=$(cut -f2 "$at/change") line=$(cut -f3 "$at/change") netlists_end=
    room=$(echo "$file" | cut -d/ -f2)
    : >"$at/executing"
    awk -v room="/unit/$room/" '
        FILENAME ~ /times$/ {time[$1] = $2; next}
        FNR in time {print time[FNR] / (index($0, room) ? 4 : 1), time[FNR], FNR, $0}' "$dir/times" "$dir/test.list" |
        sort -n >"$at/tests"
    while read -r _ spent number test; do
        executes "$number" "$file" "$line" || continue
        echo "$spent $test" >>"$at/executing"
        case $test in
        netlist*)
            [ "${QUICK:-no}" = no ] || continue
            [ -n "$netlists_end" ] || netlists_end=$(($(date +%s) + ${SECONDS_EACH:-120}))
            [ "$(date +%s)" -lt "$netlists_end" ] || continue
            # shellcheck disable=SC2046 # objects
            [ -f "$at/nonsmooth.cm" ] || link_models "$at" $(objects "$1")
            export NONSMOOTH_CM="$at/nonsmooth.cm"
            # shellcheck disable=SC2086 # words
            limited $((spent / 10 + 5)) "$0" --netlist "$at/netlist" ${test#netlist} || { echo "$test" && return; }
            ;;
        *)
            [ "${QUICK:-no}" = no ] || [ "$spent" -lt 100 ] || continue
            # shellcheck disable=SC2046,SC2086 # objects, options
            [ -f "$at/libnonsmooth-test.so" ] ||
                $CC -shared -Wl,-soname,libnonsmooth-test.so $WRAP $(objects "$1") -o "$at/libnonsmooth-test.so" $LIBS
            LD_LIBRARY_PATH=$at limited $((spent / 10 + 5)) "$test" || { echo "$test" && return; }
            ;;
        esac
    done <"$at/tests"
    [ "${QUICK:-no}" = no ] || return
    grep -v ' netlist ' "$at/executing" | head -n 4 >"$at/few"
    while read -r spent test; do
        [ "$spent" -lt 100 ] || continue
        LD_LIBRARY_PATH=$at limited $((spent + 60)) valgrind -q --leak-check=full --errors-for-leak-kinds=definite \
            --error-exitcode=9 "$test" || { echo "valgrind $test" && return; }
    done <"$at/few"
    case $room in
    linalg | mlcp | tool) ;;
    waveform)
        # shellcheck disable=SC2046 # objects
        [ -f "$at/nonsmooth.cm" ] || link_models "$at" $(objects "$1")
        NONSMOOTH_CM=$at/nonsmooth.cm RUNS="auto squares devices" JOBS=1 limited 300 tests/waveform/run.sh ||
            echo tests/waveform/run.sh
        return
        ;;
    *) return ;;
    esac
    tool=$dir/obj/src/tool/nsc_mlcp.o
    case $file in src/tool/*) tool=$at/mutant.o ;; esac
    # shellcheck disable=SC2046,SC2086
    $CC $tool $(objects "$1") -o "$at/tool" $LIBS
    limited 60 tests/tool/run.sh "$at/tool" || echo tests/tool/run.sh
}

# judge MUTANT: prints and keeps the verdict: noticed, lives, or no mutant (it does not compile, or to the same).
judge() {
    at=$made/$1
    [ ! -f "$at/verdict" ] || { cat "$at/verdict" && return; }
    [ "$(cat "$made"/*/verdict 2>/dev/null | grep -c '^[nl]')" -lt "$2" ] || return
    mkdir -p "$at"
    sed -n "${1}p" "$dir/picked" >"$at/change"
    compile "$1"
    IFS=$tab read -r _ file line function before after <"$at/change"
    if [ ! -f "$at/mutant.o" ]; then
        verdict="same $file:$line"
    else
        by=$(noticed_by "$1")
        verdict="noticed $file:$line $function, by $(echo "${by#"$dir/tests/"}" | sed "s|$dir/||g")"
        [ -n "$by" ] || verdict="lives $file:$line $function, executed by $(wc -l <"$at/executing") tests
    $before
    $after"
        reason=$(FILE=$file BEFORE=$before AFTER=$after awk -F' [|] ' '
            $1 == ENVIRON["FILE"] && $2 == ENVIRON["BEFORE"] && $3 == ENVIRON["AFTER"] {print "    because: " $4; exit}' \
            tests/mutants/accepted)
        [ -n "$by" ] || verdict="$verdict${reason:+
$reason}"
    fi
    find "$at" -mindepth 1 ! -name change ! -name executing -delete
    echo "$verdict" | tee "$at/verdict.part"
    mv "$at/verdict.part" "$at/verdict"
}

case $1 in
--netlist) netlist "$2" "$3" "$4"; exit ;;
--record) record "$2"; exit 0 ;;
--judge) judge "$2" "$3"; exit 0 ;;
esac
most=$1 seed=$2
# The tests, and which lines each of them executes: anew where the library or the tests were built anew.
if [ -n "$(find "$dir/lines/libnonsmooth-test.so" "$dir"/tests -newer "$dir/recorded" 2>/dev/null)" ] || [ ! -f "$dir/recorded" ]; then
    rm -rf "$dir/runs" "$made"
    for program in "$dir"/tests/unit/*/* "$dir"/tests/property/* "$dir"/tests/reference/* "$dir"/tests/fault/*; do
        [ ! -x "$program" ] || echo "$program"
    done >"$dir/list"
    tests/netlist/run.sh --list | grep -v ' @' | sed 's/^/netlist /' | cut -d' ' -f1-3 >>"$dir/list"
    mv "$dir/list" "$dir/test.list"
    # shellcheck disable=SC2046 # objects
    link_models "$dir/lines" $(find "$dir/lines/obj/src" -name '*.o' ! -path '*/tool/*') -lgcov
    # shellcheck disable=SC2016 # the script's
    printf '#!/bin/sh\nGCOV_PREFIX=$PWD exec %s "$@"\n' "${NGSPICE:-ngspice}" >"$dir/ngspice"
    GCOV_PREFIX_STRIP=$(echo "$dir/lines" | tr -cd / | wc -c)
    export GCOV_PREFIX_STRIP
    chmod +x "$dir/ngspice"
    seq "$(wc -l <"$dir/test.list")" | xargs -P "${JOBS:-$(nproc)}" -n1 "$0" --record
    cat "$dir"/runs/*/time >"$dir/times"
    touch "$dir/recorded"
fi

# shellcheck disable=SC2086 # folders
find ${MUTANTS_IN:-src} -name "*.c" | sort | xargs awk -f tests/mutants/candidates.awk >"$dir/candidates"
awk -v seed="$seed" -v most=$((2 * most + 20)) -f tests/mutants/pick.awk "$dir/candidates" >"$dir/picked.new"
cmp -s "$dir/picked.new" "$dir/picked" || rm -rf "$made"
mv "$dir/picked.new" "$dir/picked"
mkdir -p "$made"
echo "seed $seed, $(wc -l <"$dir/candidates") candidates"

seq "$(wc -l <"$dir/picked")" | xargs -P "${JOBS:-$(nproc)}" -I{} "$0" --judge {} "$most"
cat "$made"/*/verdict | awk '
    /^noticed/ {n++}
    /^[nl]/ {all++}
    END {print n + 0 " of " all + 0 " noticed"; exit !(all && n >= 0.85 * all)}'
