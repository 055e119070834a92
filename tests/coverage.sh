#!/bin/sh
# tests/coverage.sh - runs the unit tests of a build with --coverage and tells the lines of src/ they ran.
#
#     tests/coverage.sh BUILD
cd "$(dirname "$0")/.." || exit 1
build=$1
find "$build" -name '*.gcda' -delete
for program in "$build"/tests/[!b]*/*; do
    OPENBLAS_NUM_THREADS=1 "$program" >/dev/null 2>&1 || echo "$program failed"
done
find "$build/obj/src" -name '*.gcda' -exec gcov -n {} + 2>/dev/null | awk '
    /^File .src\/.*\.c/ {gsub(/\x27/, "", $2); file = $2}
    /^Lines executed:/ && file {
        split($2, part, /[:%]/); lines = $4; share = part[2] + 0
        printf "%6.1f %% of %4d  %s\n", share, lines, file
        all += lines; ran += lines * share / 100; file = ""
    }
    END {printf "%6.1f %% of %4d  src/\n", 100 * ran / all, all}' | sort -k5
