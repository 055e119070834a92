#!/bin/sh
# tests/waveform/run.sh - what ngspice shows of circuits with closed forms: extremes, means, integrals, instants.
#
#     tests/waveform/run.sh [name...]      name: part of a circuit's name; none: all
#
# Every tests/waveform/X.cir is a netlist as a user writes it, with the checks in comments (README.md says how).  It runs
#   auto     as it is: every check within 1e-3
#   sparse   with method="sparse": the same
#   fine     with lines=1e-5: every check within ten times that, 1e-4
#   theta    with method="theta", only flood_*.cir: only its rows (time points) are judged
#   squares  with squares=1e-3: effective values of straight ramps within 1e-3
#   devices  with the charges @axx[q] and energies @axx[e] saved, which are exact whatever the points: 1e-5
#   grid     with points="grid": its rows are counted
# One line a check: `ok` or `FAIL`, circuit, values varied, run, quantity, expected, got, error.  One line a circuit with
# the rows of its runs; the last line counts the failures and names the worst error of every run.  Exit status 1 if one failed.
# Environment: NONSMOOTH_CM (build/nonsmooth.cm), NGSPICE (ngspice), TIME_LIMIT (60 s a run), JOBS (number of processors),
# RUNS ("auto sparse fine squares devices grid"), KEEP (a folder for the runs).
set -u
here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
CM=$(readlink -f "${NONSMOOTH_CM:-$top/build/nonsmooth.cm}") || exit 2
NGSPICE=${NGSPICE:-ngspice}
TIME_LIMIT=${TIME_LIMIT:-60}
RUNS=${RUNS:-auto sparse fine squares devices grid}
export NGSPICE_MEAS_PRECISION=12

# option RUN: what stands in .model nonsmooth(...).
option() {
    case $1 in
    sparse) echo 'method="sparse"' ;;
    fine) echo 'lines=1e-5' ;;
    theta) echo 'method="theta"' ;;
    grid) echo 'points="grid"' ;;
    squares) echo 'squares=1e-3' ;;
    esac
}

# run_one FOLDER RUN: FOLDER/netlist and FOLDER/meas by ngspice, into FOLDER/RUN/out.
run_one() {
    at=$1/$2
    mkdir -p "$at" || exit 2
    echo "codemodel '$CM'" >"$at/.spiceinit"
    options=$(option "$2")
    {
        cat "$1/netlist"
        [ -z "$options" ] || printf 'AOPT 0 nsopt\n.model nsopt nonsmooth(%s)\n' "$options"
        printf '.control\nset numdgt=12\n'
        [ "$2" != devices ] || cat "$1/save"
        printf 'run\n'
        case $2 in
        devices | squares) cat "$1/meas.$2" ;;
        *) cat "$1/meas" ;;
        esac
        printf 'quit 0\n.endc\n.end\n'
    } >"$at/run.cir"
    (cd "$at" && HOME=$at exec timeout -k 5 "$TIME_LIMIT" "$NGSPICE" -b run.cir >out 2>&1 </dev/null)
    echo "status $?" >>"$at/out"
}

# circuit NUMBER FILE "NAME=VALUE... [; RUN...]": all runs, or of them those named, of one netlist with these values; one line a check.
circuit() {
    dir=$SCRATCH/$(basename "$2" .cir).$1
    mkdir -p "$dir" || exit 2
    values=${3%% ;*}
    [ "$values" = "$3" ] || RUNS=$(for run in $RUNS; do case " ${3#*;} " in *" $run "*) echo "$run" ;; esac; done)
    label=$(basename "$2" .cir)${values:+ $values}
    if ! awk -v vary="$values" -v folder="$dir" -f "$here/prepare.awk" "$2" >"$dir/formulas.awk" ||
        ! awk -f "$dir/formulas.awk"; then
        echo "FAIL $label: its checks cannot be read"
        return
    fi
    case $2 in
    flood_*) RUNS="$RUNS theta" ;;
    fine_*) RUNS=$(echo "$RUNS" | sed 's/grid//') ;; # it would take a minute
    esac
    [ -s "$dir/meas.devices" ] || RUNS=$(echo "$RUNS" | sed 's/devices//')
    [ -s "$dir/meas.squares" ] || RUNS=$(echo "$RUNS" | sed 's/squares//')
    for run in $RUNS; do
        run_one "$dir" "$run"
        awk -v label="$label" -v run="$run" -f "$here/judge.awk" "$dir/checks$(case $run in devices | squares) echo ".$run" ;; esac)" "$dir/$run/out"
    done
    counts=
    for run in $RUNS; do counts="$counts $run $(sed -n 's/^No. of Data Rows : *//p' "$dir/$run/out" | tail -n 1)"; done
    echo "rows $label:$counts"
}

if [ "${1:-}" = --one ]; then
    circuit "$2" "$3" "$4" >"$SCRATCH/$(basename "$3" .cir).$2.said" # as a whole: others run beside it
    exit
fi
if [ ! -f "$CM" ]; then
    echo "run.sh: there is no $CM" >&2
    exit 2
fi
SCRATCH=${KEEP:-$(mktemp -d)} || exit 2
mkdir -p "$SCRATCH" && SCRATCH=$(cd "$SCRATCH" && pwd) || exit 2
[ -n "${KEEP:-}" ] || trap 'rm -rf "$SCRATCH"' EXIT
export NONSMOOTH_CM="$CM" NGSPICE TIME_LIMIT RUNS SCRATCH

cd "$here" || exit 2
for n in "$@"; do echo "$n"; done >"$SCRATCH/names"
[ $# -gt 0 ] || echo >"$SCRATCH/names"
for f in *.cir; do
    # its own values first, then one line `*~ NAME=VALUE...` after the other
    { echo; sed -n 's/^\*~ *//p' "$f"; } | awk -v f="$f" '{ printf "%d\n%s\n%s\n", NR, f, $0 }' >"$SCRATCH/one"
    echo "$f" | grep -q -F -f "$SCRATCH/names" && cat "$SCRATCH/one"
done | tr '\n' '\0' | xargs -0 -P "${JOBS:-$(nproc)}" -n3 "$here/run.sh" --one
cat "$SCRATCH"/*.said | tee "$SCRATCH/verdicts"
awk '/^ok / || /^FAIL / { checks++; failed += $1 == "FAIL" }
     / error / { for (i = 1; i < NF; i++) if ($i == "run") run = $(i + 1)
                 error = $NF == "nothing" ? "none" : $NF
                 if (error == "none") missing[run]++; else if (!(run in worst) || error + 0 > worst[run]) worst[run] = error + 0
                 seen[run] }
     END { printf "%d checks, %d failed; worst error:", checks, failed
           for (run in seen) printf " %s %.2g%s", run, worst[run], run in missing ? " (" missing[run] " without a value)" : ""
           print ""
           exit failed > 0 || checks == 0 }' "$SCRATCH/verdicts"
