#!/bin/sh
# tests/fuzz.sh - the fuzzers of build/fuzz, side by side.
#
#     tests/fuzz.sh SECONDS [TIMEOUT]
#
# TIMEOUT: seconds that one input may take, 300. One that takes longer is in tests/known/ (fuzz_systems.chatters).
# Prints for each what it ran.  The bytes of a find stay in build/fuzz/find/, for  build/fuzz/tests/fuzz/NAME FILE.
# What was learnt stays in build/fuzz/corpus/; runs of less than a minute start from the seeds alone, and always
# in the same way.
cd "$(dirname "$0")/.." || exit 1
seconds=$1 timeout=${2:-300}
build=build/fuzz
mkdir -p $build/find $build/seeds
status=0
export OPENBLAS_NUM_THREADS=1 # the matrices are small

# Seeds: problems for the one; a few bytes of each sort for the other.
printf '2  2 1 1 2  -1 -1  0 0  inf inf # a pair of pairs\n' >$build/seeds/fuzz_text.a
printf '3\n1e-3 0 -1\n0 2 0\n1 0 0\n-5 .5 1e2\n-inf -1 0\ninf 1 0\n' >$build/seeds/fuzz_text.b
cp tests/fuzz/seeds/* $build/seeds # what once went wrong
for file in tests/problems/*.txt; do
    [ ! -f "$file" ] || cp "$file" "$build/seeds/fuzz_text.$(basename "$file")"
done
# Two states, two pairs; a source, a diode and a resistor.
printf '\024\000\002\002\000\000\010\000\000\010\370\000\010\000' >$build/seeds/fuzz_systems.a
printf '\024\001\003\004\001\000\000\010\012\001\002\000\000\001\001\000\000\002\000\010' >$build/seeds/fuzz_systems.b

# fuzz NAME: into NAME's log.
fuzz() {
    name=$1 corpus=$build/corpus/$1 repeat=
    if [ "$seconds" -lt 60 ]; then
        corpus=$build/corpus/$name.short repeat=-seed=1
        rm -rf "$corpus"
    fi
    mkdir -p "$corpus"
    cp $build/seeds/"$name".* "$corpus"
    UBSAN_OPTIONS=print_stacktrace=1 $build/tests/fuzz/"$name" "$corpus" -max_total_time="$seconds" -timeout="$timeout" \
        -print_final_stats=1 -artifact_prefix=$build/find/"$name." $repeat >$build/"$name".log 2>&1 </dev/null
    echo $? >$build/"$name".status
}

# tell NAME
tell() {
    name=$1 log=$build/$1.log
    runs=$(awk '/stat::number_of_executed_units/ {print $2}' "$log")
    covered=$(awk '{for (k = 2; k < NF; k++) if ($k == "cov:") c = $(k + 1)} END {print c + 0}' "$log")
    if [ "$(cat "$build/$name.status")" = 0 ]; then
        echo "ok $name: $runs runs in $seconds s, $covered coverage counters, no crash"
    else
        echo "FAIL $name: after $runs runs, $covered coverage counters"
        grep -E -m3 "^$name:|Sanitizer|runtime error|Test unit written" "$log"
        grep 'Test unit written' "$log"
        status=1
    fi
}

for program in "$build"/tests/fuzz/fuzz_*; do
    [ ! -x "$program" ] || fuzz "$(basename "$program")" &
done
wait
for program in "$build"/tests/fuzz/fuzz_*; do
    [ ! -x "$program" ] || tell "$(basename "$program")"
done
exit $status
