#!/bin/sh
# tests/ngspice-asan.sh - ngspice with the address sanitizer's run time loaded first, so that a code model
# built with it can be loaded.  Leaks are not looked for: ngspice itself has many.
LD_PRELOAD="$(gcc -print-file-name=libasan.so) $(gcc -print-file-name=libubsan.so)"
ASAN_OPTIONS=detect_leaks=0:halt_on_error=1:exitcode=99
UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
export LD_PRELOAD ASAN_OPTIONS UBSAN_OPTIONS
exec ngspice "$@"
