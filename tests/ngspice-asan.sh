#!/bin/sh
# tests/ngspice-asan.sh - ngspice with the address sanitizer's run time loaded first, so that a code model
# built with it can be loaded.
#
# Shows only reports with a frame in our code model, and crashes: ngspice reads past ends by itself (its parser
# of B sources, for one).  Leaks are not looked for: it has many.  PLAIN_NGSPICE names the program (default: ngspice).
reports=$(mktemp -d) || exit 2
trap 'rm -rf "$reports"' EXIT
trap : INT # it is for ngspice

LD_PRELOAD="$(gcc -print-file-name=libasan.so) $(gcc -print-file-name=libubsan.so)" \
    ASAN_OPTIONS="detect_leaks=0:halt_on_error=0:log_path=$reports/asan:stack_trace_format='    #%n %f %L (%m)'" \
    UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 "${PLAIN_NGSPICE:-ngspice}" "$@"
status=$?

for report in "$reports"/*; do
    [ -f "$report" ] || continue
    # A record is a report; mawk and gawk both take a regular expression as separator.
    awk 'BEGIN {RS = "\n=================+\n"} /nonsmooth\.cm|: SEGV|runtime error/ {print; bad = 1} END {exit bad}' \
        "$report" >&2 || status=99
done
exit $status
