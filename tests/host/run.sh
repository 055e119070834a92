#!/bin/sh
# tests/host/run.sh - a program that uses libngspice gets every line of ours, whole and on a line of its own.
#
#     tests/host/run.sh [name...]      name: part of a netlist's name; none: all that make us write, and a session (session.c)
#
# Each netlist of tests/netlist/errors, and those of cases that set `verbose`, run in ngspice -b and in build/tests/host/host:
# with their .control sections (source); those with an analysis also without, by `run` and by `bg_run`.  What ngspice -b prints after "nonsmooth: " and what the host is given after
# "Instance: nonsmooth   Message: " must be the same lines, one at least, but for CPU times; and
# the host's own stdout and stderr stay empty.  Verdicts as tests/netlist/run.sh.  Environment: NONSMOOTH_CM, NGSPICE.
set -u
top=$(cd "$(dirname "$0")/../.." && pwd)
CM=$(readlink -f "${NONSMOOTH_CM:-$top/build/nonsmooth.cm}") || exit 2
PROGRAM=$top/build/tests/host/host
NGSPICE=${NGSPICE:-ngspice}

# lines PATTERN FILE: what follows our mark, without CPU times.
lines() {
    sed -n "s/^$1\\(.*\\)\$/\\1/p" "$2" | sed -e 's/]$//' -e 's/[^ ]* ms CPU time/ms/'
}

# one FILE COMMAND: prints the verdict.
one() {
    name="host/$(basename "$1" .cir) $2"
    dir=$SCRATCH/$(basename "$1" .cir).$2
    mkdir -p "$dir" && cd "$dir" || exit 2
    beside="setcs sourcepath = ( \$sourcepath '$(dirname "$CM")' )" # nonsmooth.inc
    printf '%s\n' "codemodel '$CM'" "$beside" >.spiceinit
    if [ "$2" = source ]; then cat "$1"; else
        sed -e '/^\.control/,/^\.endc/d' -e 's/^\.end$/.control\nrun\nquit\n.endc\n.end/' "$1"
    fi >netlist.cir
    HOME=$dir timeout 60 "$NGSPICE" -b netlist.cir >printed 2>&1 </dev/null
    echo "$beside" >.spiceinit
    HOME=$dir timeout 60 "$PROGRAM" "$CM" netlist.cir "$2" given >raw 2>&1 </dev/null
    rc=$?
    lines 'nonsmooth: ' printed >expected
    lines '\[stdout Instance: nonsmooth   Message: ' given >got
    reason=
    [ $rc = 0 ] || reason="the host ended with $rc"
    [ -s expected ] || reason="ngspice -b printed no line of ours"
    [ ! -s raw ] || reason="past the callback: $(head -n 1 raw)"
    difference=$(diff expected got | grep -m1 '^[<>]') && reason="printed < or given > alone: $difference"
    if [ -z "$reason" ]; then echo "ok $name"; else echo "FAIL $name $reason"; fi
}

if [ "${1:-}" = --one ]; then
    one "$top/$2" "$3"
    exit
fi
if [ "$NGSPICE${NGSPICE_SRC:-}" != ngspice ]; then
    echo "skip host another ngspice than the system's: the libngspice of that version is not known"
    exit
fi
if [ ! -x "$PROGRAM" ]; then
    echo "skip host there is no $PROGRAM: libngspice0-dev is not installed"
    exit
fi
SCRATCH=$(mktemp -d) || exit 2
trap 'rm -rf "$SCRATCH"' EXIT
export NONSMOOTH_CM="$CM" PROGRAM NGSPICE SCRATCH
cd "$top" || exit 2 # names in the list are without spaces, whatever stands before them
{
    ls tests/netlist/errors/*.cir
    grep -l 'verbose=1' tests/netlist/cases/*.cir
} | grep -F "$(printf '%s\n' "${@:-/}")" | while read -r file; do
    grep -q '^\.control' "$file" && echo "$file source"
    grep -q -E '^\.(op|dc|tran|tf|ac|noise|pz|sens|disto|pss)( |$)' "$file" && printf '%s\n' "$file run" "$file bg_run"
done |
    xargs -P 4 -L1 tests/host/run.sh --one >"$SCRATCH/verdicts" # they sleep most of the time
if [ $# = 0 ]; then
    (cd "$SCRATCH" && HOME=$SCRATCH exec timeout 300 "$top/build/tests/host/session" "$CM") >"$SCRATCH/session" 2>"$SCRATCH/session.err" </dev/null ||
        echo "FAIL host_session ended with $?" >>"$SCRATCH/session"
    grep -E '^(ok|FAIL) ' "$SCRATCH/session" >>"$SCRATCH/verdicts"
fi
sort "$SCRATCH/verdicts"
! grep -q '^FAIL' "$SCRATCH/verdicts" && grep -q '^ok' "$SCRATCH/verdicts"
