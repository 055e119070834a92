#!/bin/sh
# tests/compare/cost.sh - what it costs that engines are judged (src/verify): instructions of each circuit of
# `make compare` by the library, and by the same library with the calls of its check replaced (unchecked.c).
#
#     tests/compare/cost.sh [CIRCUIT...]
#
# `make check-cost` calls it.  Fails where the check costs more than 5 % of a run, or 5 % of all of them.
set -eu
cd "$(dirname "$0")/../.."
export OPENBLAS_NUM_THREADS=1
out=build/compare
mkdir -p "$out"

# program NAME OPTION...: the circuits.
program() {
    name=$1
    shift
    # shellcheck disable=SC2086 # options
    ${CC:-gcc} -std=c11 ${CFLAGS:--O2 -g} -ffunction-sections -Iinclude -Isrc -Itests/rig -Itests/bench \
        tests/compare/main.c tests/compare/circuits.c tests/bench/cases*.c tests/bench/deck.c tests/bench/oracle.c \
        tests/rig/lit*.c "$@" -Wl,--gc-sections build/libnonsmooth.a -o "$out/$name" \
        ${LIBS:--llapacke -llapack -lblas -lklu -lm}
}
program checked
program unchecked tests/compare/unchecked.c -Wl,--wrap=ns_march_check_create,--wrap=ns_march_check_attach \
    -Wl,--wrap=ns_march_check_begin,--wrap=ns_march_check_end

# count PROGRAM ARGUMENT...: how many instructions it takes.
count() {
    program=$1
    shift
    valgrind --tool=callgrind --callgrind-out-file="$out/$program.callgrind" --log-file="$out/$program.log" \
        "$out/$program" "$@" >/dev/null
    awk '/Collected/ {print $NF}' "$out/$program.log"
}

idle=$(count unchecked list)
"$out/checked" list | while read -r circuit engine; do
    [ $# = 0 ] || echo " $* " | grep -q " $circuit " || continue
    "$out/checked" "$circuit" "$engine" "$out/result"
    checks=$(awk '$1 == "count:checks" {c = $2} $1 == "count:retries" {r = $2} $1 == "count:events" {e = $2}
        END {print e, c, r}' "$out/result")
    echo "$circuit $engine $idle $(count checked "$circuit" "$engine") $(count unchecked "$circuit" "$engine") $checks"
done | awk '
    BEGIN {printf "%-13s %-7s %14s %8s %9s %9s %8s\n", "circuit", "engine", "instructions", "check", "events", "checks", "retries"}
    {
        part = ($4 - $5) / ($5 - $3)
        printf "%-13s %-7s %14.0f %6.2f %% %9d %9d %8d\n", $1, $2, $5 - $3, 100 * part, $6, $7, $8
        fflush()
        if (part > worst) {worst = part; at = $1 " " $2}
        sum += part
        runs++
    }
    END {
        printf "mean %.2f %%, most %.2f %% (%s)\n", 100 * sum / runs, 100 * worst, at
        exit worst > 0.05
    }'
