#!/bin/sh
# tests/corpus/run.sh - real netlists from public repositories, with one line more, beside ngspice's own models.
#
#     tests/corpus/run.sh FOLDER [LIST]    FOLDER: holds OWNER/NAME/PATH of what LIST (tests/corpus/list) names
#
# Each netlist is flattened (flatten.awk), gets `.include nonsmooth.inc`, and is run natively; then with its D as ngspice's smooth
# model of the same vf, ron and breakdown (smooth.awk) and its S, W as they are; then as it is.  The means of all node voltages are compared.
# A line for each netlist, and at the end what the goals count:
#     native NAME PERCENT_OF_SMOOTH PERCENT_OF_OWN CPU_NATIVE CPU_OWN NODE    refused NAME: LINE    failed NAME: LINE    absent NAME
# "-": no reference (ngspice did not get to the end within TIME_LIMIT).  Exit status 1 if a goal is missed.
# Environment: NONSMOOTH_CM, NGSPICE, TIME_LIMIT (30 s a run), JOBS (1), KEEP (a folder for the runs).
set -u
here=$(cd "$(dirname "$0")" && pwd)
CM=$(readlink -f "${NONSMOOTH_CM:-$here/../../build/nonsmooth.cm}") || exit 2
NGSPICE=${NGSPICE:-ngspice} TIME_LIMIT=${TIME_LIMIT:-30}

# text_of RAW: the header of a binary raw file, and its numbers as text.
text_of() {
    LC_ALL=C sed '/^Binary:/q' "$1"
    begin=$(LC_ALL=C grep -abo -m1 '^Binary:' "$1" | cut -d: -f1)
    count=$(LC_ALL=C sed -n 's/^No. Variables: *//p;/^Binary:/q' "$1")
    tail -c "+$((begin + 9))" "$1" | od -A n -v -t f8 -w$((8 * count))
}

# simulate NETLIST NAME: NAME.out, NAME.cpu (s, its start included), NAME.means; fails if it did not get to its end.
simulate() {
    rm -f "$2.raw" "$2.means"
    (
        HOME=$PWD timeout -k 5 "$TIME_LIMIT" "$NGSPICE" -b -r "$2.raw" "$1" >"$2.out" 2>&1 </dev/null
        times >"$2.times"
    )
    tail -n 1 "$2.times" | tr 'ms' '  ' | awk '{ printf "%.2f\n", 60 * ($1 + $3) + $2 + $4 }' >"$2.cpu"
    [ -s "$2.raw" ] && grep -q '^No. of Data Rows' "$2.out" && ! grep -qi 'aborted' "$2.out" || return 1
    text_of "$2.raw" | LC_ALL=C awk -f "$here/means.awk" >"$2.means"
    rm -f "$2.raw"
    [ -s "$2.means" ]
}

# against REFERENCE: the largest difference in percent, and the node.
against() {
    if [ -s "$1" ]; then awk -f "$here/compare.awk" "$1" native.means; else echo "- -"; fi
}

# one REPOSITORY PATH DIALECT
one() {
    name=$1/$2 file=$FOLDER/$1/${2%#*} block=0
    [ "${2%#*}" = "$2" ] || block=${2##*#}
    if [ ! -f "$file" ]; then echo "absent $name"; return; fi
    dir=$SCRATCH/$(echo "$name" | tr '/ #' '___')
    mkdir -p "$dir" && cd "$dir" || exit 2
    printf '%s\n' "codemodel '$CM'" "setcs sourcepath = ( \$sourcepath '$(dirname "$CM")' )" 'set norefvalue' \
        ${3:+"set ngbehavior=$3"} >.spiceinit
    LC_ALL=C awk -v "block=$block" -f "$here/flatten.awk" "$file" >own.cir
    echo .end >>own.cir
    sed '1a .include nonsmooth.inc' own.cir >native.cir
    simulate own.cir own
    if simulate native.cir native && grep -q '^nonsmooth: simulates' native.out; then
        awk -f "$here/smooth.awk" native.out own.cir >smooth.cir
        simulate smooth.cir smooth
        smooth=$(against smooth.means)
        own=$(against own.means)
        echo "native $name ${smooth% *} ${own% *} $(cat native.cpu) $(if [ -s own.means ]; then cat own.cpu; else echo -; fi) ${smooth#* }"
    elif grep -q '^nonsmooth: ' native.out; then
        echo "$(grep -q 'analysis not run\|aborted' native.out && echo refused || echo failed) $name: $(grep '^nonsmooth: ' native.out | grep -vE ' taken as (a switch|it is|they are|ideal)|: simulates this circuit' | head -n 1)"
    else
        echo "failed $name: $(grep -iE 'error|fatal|unable|could not' native.out | head -n 1)"
    fi
}

if [ "${1:-}" = --one ]; then
    one "$2" "$3" "${4:-}"
    exit
fi
if ! [ -d "${1:-}" ]; then
    echo "run.sh: give the folder of fetched files" >&2
    exit 2
fi
FOLDER=$(cd "$1" && pwd)
SCRATCH=${KEEP:-$(mktemp -d)}
mkdir -p "$SCRATCH" && SCRATCH=$(cd "$SCRATCH" && pwd) || exit 2
[ -n "${KEEP:-}" ] || trap 'rm -rf "$SCRATCH"' EXIT
export FOLDER SCRATCH NONSMOOTH_CM="$CM" NGSPICE TIME_LIMIT
# xargs takes quotes and backslashes as they are after a backslash alone
sed -e 's,[ \t]*$,,; /^#/d; /^$/d' -e "s,[\\\\\"'],\\\\&,g" "${2:-$here/list}" | xargs -P "${JOBS:-1}" -L1 "$here/run.sh" --one >"$SCRATCH/verdicts"
sort "$SCRATCH/verdicts"
awk -f "$here/goals.awk" "$SCRATCH/verdicts"
