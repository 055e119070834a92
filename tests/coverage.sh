#!/bin/sh
# tests/coverage.sh - runs the tests of the library and of nsc-mlcp, built with --coverage, and prints the lines of
# src/ they ran: every file, then those below LEAST percent again, then all together; fails if that is below.
#
#     tests/coverage.sh BUILD
cd "$(dirname "$0")/.." || exit 1
build=$1
LEAST=95
export OPENBLAS_NUM_THREADS=1
find "$build" -name '*.gcda' -delete
for program in "$build"/tests/unit/*/* "$build"/tests/property/* "$build"/tests/reference/* "$build"/tests/fault/*; do
    [ ! -x "$program" ] || "$program" >/dev/null 2>&1 || echo "$program failed"
done
tests/tool/run.sh "$build/nsc-mlcp" | grep '^FAIL'
find "$build/obj/src" -name '*.gcno' -exec gcov -n {} + 2>/dev/null | awk -v least=$LEAST '
    /^File .src\/.*\.c/ {gsub(/\x27/, "", $2); file = $2}
    /^Lines executed:/ && file {
        split($2, part, /[:%]/); share[file] = part[2] + 0; lines[file] = $4
        all += $4; ran += $4 * part[2] / 100; file = ""
    }
    /^No executable lines/ {file = ""}
    END {
        sort = "sort -k5"
        for (f in lines) printf "%6.1f %% of %4d  %s\n", share[f], lines[f], f | sort
        close(sort)
        for (f in lines) if (share[f] < least) printf "below %d %%: %s, %.1f %%\n", least, f, share[f] | "sort"
        close("sort")
        printf "%6.1f %% of %4d  src/\n", all ? 100 * ran / all : 0, all
        exit !(all && 100 * ran / all >= least)
    }'
