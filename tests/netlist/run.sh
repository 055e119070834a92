#!/bin/sh
# tests/netlist/run.sh - netlists through the installed ngspice with nonsmooth.cm, one verdict line each.
#
#     tests/netlist/run.sh [name...]      name: part of a verdict's name ("buck_ccm", "errors/"); none: all
#     tests/netlist/run.sh --list         lines "FILE VARIANT NAME" of all
#
# Verdicts `ok netlist/NAME` and `FAIL netlist/NAME reason`; exit status 1 if one failed.  NAME is
#   X default    netlists/X.cir as it is (it judges itself to 0.02 %: what .meas does between points, and digits not written)
#   X fine       by the scheme with h ten times smaller: `.model nsopt nonsmooth`, with parameters or none, gets
#                method="theta" h=(.tran's step)/160, `set tol = 0.02` becomes 0.1
#   X reversed   its elements in reverse order
#   cases/X      tests/netlist/cases/X.cir, which judges itself; of each line `* says: REGEX` one line of output matches, after `* never: REGEX` none; after `* interrupt: SECONDS` ngspice -i gets Ctrl-C then; for the N-th line
#                `* again: SED` it runs once more, as XN, with what sed makes of it
#   cases/own_X (of ngspice's own devices) and errors/X run once more as X@psa, X@ltpsa, X@hsa: with these values of ngbehavior, or those of BEHAVIORS
#   cookbook/X   netlists/cookbook/X.cir, in the same way
#   errors/X     tests/netlist/errors/X.cir: exactly one line of output matches the regular expression of its
#                first line `* expect: ...`, and it judges what was kept; after a line `* dump: FILE STATUS REGEX`
#                it has left FILE, which nsc-mlcp answers with STATUS and of which one line matches; after `* status: N`
#                ngspice ends with N in place of 0; with `* alone: FILE` ngspice begins without code models, and its FILE lies there, with `* twice: FILE` it loads FILE twice, after `* never: REGEX` no line of output matches
#   README       the netlist that README.md shows: its measurements are what the text below it says
# errors/ also fail if ngspice blames its matrix, all others on a rejected time point and on "timestep too small" or "singular" in the output;
# A netlist with a line `* until: VERSION` is left out on later versions of ngspice; everything fails on a sanitizer's or valgrind's finding, a crash, and after TIME_LIMIT seconds.
# Environment: NONSMOOTH_CM (build/nonsmooth.cm; nsc-mlcp is beside it), NGSPICE (ngspice), TIME_LIMIT (60), JOBS (number of
# processors), LINE (a line that every netlist gets after its title: ".options klu"), KEEP (a folder for the runs, to look at afterwards; else a temporary one).
set -u
here=$(cd "$(dirname "$0")" && pwd)
top=$(cd "$here/../.." && pwd)
CM=$(readlink -f "${NONSMOOTH_CM:-$top/build/nonsmooth.cm}") || exit 2
NGSPICE=${NGSPICE:-ngspice}
TIME_LIMIT=${TIME_LIMIT:-60}

# fine FILE: the netlist by the scheme with h ten times smaller and the tolerance of 0.1 %.
fine() {
    h=$(awk 'function num(s) {
                 s = tolower(s); f = 1; k = substr(s, match(s, /[a-z]*$/), 1)
                 if (k == "m") f = 1e-3; if (k == "u") f = 1e-6; if (k == "n") f = 1e-9; if (k == "p") f = 1e-12
                 return s * f }
             tolower($1) == ".tran" { h = num($2); if (h > num($3) / 50) h = num($3) / 50; print h / 160; exit }' "$1")
    grep -q '^set tol = 0.02$' "$1" && grep -q '^\.model nsopt nonsmooth\((.*)\)*$' "$1" || echo "run.sh: no tolerance or options" >&2
    sed -e "s/^\.model nsopt nonsmooth\$/&()/" -e "s/^\.model nsopt nonsmooth(/&method=\"theta\" h=$h /" -e 's/^set tol = 0.02$/set tol = 0.1/' "$1"
}

# reversed FILE: its element lines outside subcircuits from last to first, everything else in place.
reversed() {
    awk 'FNR == 1 { pass++; print_title = pass == 2 }
         { element = FNR > 1 && !inside && /^[A-Za-z]/ }
         tolower($1) == ".subckt" || tolower($1) == ".control" { inside = 1; element = 0 }
         tolower($1) == ".ends" || tolower($1) == ".endc" { inside = 0; element = 0 }
         pass == 1 && element { line[++n] = $0 }
         pass == 2 { if (element) print line[n--]; else print }' "$1" "$1"
}

# shown FILE: the netlist that a text shows.
# shellcheck disable=SC2016 # Markdown's
shown() {
    sed -n '/^```spice$/,/^```$/{/^```/!p}' "$1"
}

# worst OUTPUT: the largest of the errors that a netlist printed, and its rejected points.
worst() {
    awk '/ expected .* got .* error / { for (i = 1; i < NF; i++) if ($i == "error" && $(i + 1) + 0 >= m) { m = $(i + 1) + 0; n++ } }
         /[Rr]ejected timepoints = / { r = "  rejected points " $NF }
         END { if (n) printf "  largest error %.4f %%%s", m, r }' "$1"
}

# spinit FOLDER: where ngspice's own spinit is, which loads its code models; FOLDER/scripts gets an empty one.
# shellcheck disable=SC2016 # ngspice expands it
spinit() {
    mkdir -p "$1/scripts"
    : >"$1/scripts/spinit"
    printf '%s\n' '* where' .control 'echo path $sourcepath' 'quit 0' .endc .end >"$1/scripts/where.cir"
    echo "$("$NGSPICE" -n -b "$1/scripts/where.cir" 2>&1 </dev/null | sed -n 's/^path \. \([^ ]*\).*/\1/p')/spinit"
}

# alone FOLDER FILE: ngspice is to load no code models of its own; FILE, one of them, is put there.
alone() {
    ln -sfn "$(sed -n "s,^ *codemodel *\(.*/$2\) *\$,\1,p" "$(spinit "$1")")" "$1/$2"
}

# one FILE VARIANT: runs it in a folder of its own and prints the verdict.
one() {
    file=$1 variant=$2 base=$(basename "$1" .cir)
    case $file in
    */cases/*) name="cases/$base${variant#-}" kind=case ;;
    */cookbook/*) name="cookbook/$base${variant#-}" kind=case ;;
    */errors/*) name=errors/$base${variant#-} kind=error ;;
    README.md) name=README kind=readme ;;
    *) name="$base $variant" kind=netlist ;;
    esac
    dir=$SCRATCH/$(echo "$name" | tr ' /' '__')
    mkdir -p "$dir" || exit 2
    ln -sfn "$top/netlists/lib" "$dir/lib"
    printf '%s\n' "codemodel '$CM'" "setcs sourcepath = ( \$sourcepath '$(dirname "$CM")' )" >"$dir/.spiceinit"
    case $variant in @*) echo "set ngbehavior=${variant#@}" >>"$dir/.spiceinit" ;; esac
    case $variant in
    fine) fine "$file" ;;
    reversed) reversed "$file" ;;
    README) shown "$file" ;;
    -[1-9]) sed "$(sed -n 's/^\* again: //p' "$file" | sed -n "${variant#-}p")" "$file" ;;
    *) cat "$file" ;;
    esac | sed -e 's/^run$/run\nrusage rejected/' ${LINE:+-e "1a $LINE"} >"$dir/$base.cir"
    wanted=$(sed -n 's/^\* alone: //p' "$file")
    interrupted=$(sed -n 's/^\* interrupt: //p' "$file") way=-b
    [ -z "$interrupted" ] || way=-i # -b leaves it to the system
    [ -z "$wanted" ] || alone "$dir" "$wanted"
    again=$(sed -n 's/^\* twice: //p' "$file")
    [ -z "$again" ] || sed -n "/^ *codemodel .*\/$again *\$/p" "$(spinit "$dir")" | cat - "$dir/.spiceinit" >"$dir/twice"
    [ -z "$again" ] || mv "$dir/twice" "$dir/.spiceinit"
    (cd "$dir" && HOME=$dir exec env ${wanted:+"SPICE_SCRIPTS=$dir/scripts"} timeout -k 5 "$TIME_LIMIT" ${interrupted:+timeout --preserve-status -s INT "$interrupted"} "$NGSPICE" "$way" "$base.cir" >out 2>&1 </dev/null)
    rc=$?
    reason=$(judge "$dir/out" $rc $kind "$file")
    if [ -z "$reason" ]; then echo "ok netlist/$name$(worst "$dir/out")"; else echo "FAIL netlist/$name $reason"; fi
    [ -z "$reason" ]
}

# outside OUTPUT: the first line "... error E % tolerance T %" with E missing or above T.
outside() {
    awk '/ tolerance / { e = "%"
             for (i = 1; i < NF; i++) { if ($i == "error") e = $(i + 1); if ($i == "tolerance") t = $(i + 1) }
             if (e == "%" || e + 0 > t + 0) { print; found = 1; exit } }
         END { exit !found }' "$1"
}

# measured OUTPUT NAME VALUE PERCENT: prints what .meas NAME gave if that is not within PERCENT of VALUE.
measured() {
    awk -v name="$2" -v value="$3" -v percent="$4" '
        $1 == name && $2 == "=" { got = $3 }
        END { e = 100 * (got / value - 1)
              if (!(e <= percent && e >= -percent))
                  print name " = " value " expected within " percent " %, got " (got == "" ? "nothing" : got) }' "$1"
}

# dumped FOLDER FILE STATUS REGEX: prints why the dump of a step is not what it should be, or nothing.
dumped() {
    if [ ! -f "$1/$2" ]; then echo "no $2 was written"; return; fi
    said=$("$(dirname "$CM")/nsc-mlcp" "$1/$2" 2>&1)
    got=$?
    if [ $got != "$3" ]; then echo "nsc-mlcp answers $2 with $got: $(echo "$said" | head -n 1)"; return; fi
    lines=$(grep -c -E -e "$4" "$1/$2")
    [ "$lines" = 1 ] || echo "$lines lines of $2 match /$4/"
}

# judge OUTPUT STATUS KIND FILE: prints why it failed, or nothing.
judge() {
    if [ "$2" = 124 ]; then echo "took more than $TIME_LIMIT s"; return; fi
    if [ "$2" -gt 128 ]; then echo "crashed: signal $(($2 - 128))"; return; fi
    found=$(grep -m1 -E 'Sanitizer|runtime error:|^==[0-9]+== ' "$1") && { echo "$found"; return; }
    never=$(sed -n 's/^\* never: //p' "$4")
    found=$([ -n "$never" ] && grep -m1 -i -E -e "$never" "$1") && { echo "says: $found"; return; }
    if [ "$3" = error ]; then
        expect=$(sed -n '1s/^\* expect: //p' "$4")
        if [ -z "$expect" ]; then echo "no * expect: line"; return; fi
        lines=$(grep -c -i -E -e "$expect" "$1")
        if [ "$lines" != 1 ]; then
            echo "$lines lines match /$expect/; says: $(grep -m1 -i 'nonsmooth' "$1")"; return
        fi
        found=$(grep -m1 -i -E 'matrix is singular|singular matrix' "$1") && { echo "blames the matrix: $found"; return; }
        status=$(sed -n 's/^\* status: //p' "$4")
        if [ -n "$status" ]; then
            [ "$status" = "$2" ] || echo "ends with $2, not $status"
            return
        fi
        dump=$(sed -n 's/^\* dump: //p' "$4")
        if [ -n "$dump" ]; then
            rest=${dump#* }
            found=$(dumped "${1%/*}" "${dump%% *}" "${rest%% *}" "${rest#* }")
            [ -z "$found" ] || { echo "$found"; return; }
        fi
    else
        found=$(grep -m1 -i -E 'timestep too small|singular' "$1") && { echo "$found"; return; }
        found=$(grep -m1 -E 'ejected timepoints = [1-9]' "$1") && { echo "$found"; return; }
        found=$(sed -n 's/^\* says: //p' "$4" | while read -r says; do
            [ "$(grep -c -E -e "$says" "$1")" = 1 ] || echo "no line, or many, match /$says/"
        done | head -n 1)
        [ -z "$found" ] || { echo "$found"; return; }
    fi
    if [ "$2" != 0 ]; then
        outside "$1" || grep '^nonsmooth: ' "$1" | grep -v 'simulates this circuit: ' | grep -m1 . || grep expected "$1" | tr '\n' ' ' | grep . || echo "status $2"
    elif [ "$3" = readme ]; then # D Vin exactly; the ripple's closed form is in netlists/buck_ccm.cir
        { measured "$1" vout 4.8 0.1 && measured "$1" ripple 0.2886 1; } | paste -sd' ' -
    fi
}

# too_late FILE: true if it has a line `* until: VERSION` and this ngspice is a later one.
too_late() {
    until=$(sed -n 's/^\* until: //p' "$1")
    [ -n "$until" ] && [ "$(printf '%s\n' "$until" "$version" | sort -V | head -n 1)" != "$version" ]
}

# list: what there is to run.
list() {
    version=$("$NGSPICE" --version 2>/dev/null </dev/null | sed -n 's/^\*\* ngspice-\([^ ]*\).*/\1/p')
    for f in netlists/*.cir; do
        for v in default fine reversed; do echo "$f $v $(basename "$f" .cir) $v"; done
    done
    for k in cases errors cookbook; do
        for f in "tests/netlist/$k"/*.cir "netlists/$k"/*.cir; do
            if [ ! -f "$f" ] || too_late "$f"; then continue; fi
            echo "$f - $k/$(basename "$f" .cir)"
            case $f in */own_* | */errors/*) for b in ${BEHAVIORS-psa ltpsa hsa}; do echo "$f @$b $k/$(basename "$f" .cir)@$b"; done ;; esac
            again=$(grep -c '^\* again: ' "$f")
            for n in $(seq "$again"); do echo "$f -$n $k/$(basename "$f" .cir)"; done
        done
    done
    echo "README.md README README"
}

if [ "${1:-}" = --list ]; then
    cd "$top" && list
    exit
fi
if [ "${1:-}" = --one ]; then
    one "$2" "$3"
    exit
fi
if [ ! -f "$CM" ]; then
    echo "run.sh: there is no $CM" >&2
    exit 2
fi
SCRATCH=${KEEP:-$(mktemp -d)} || exit 2
mkdir -p "$SCRATCH" && SCRATCH=$(cd "$SCRATCH" && pwd) || exit 2
[ -n "${KEEP:-}" ] || trap 'rm -rf "$SCRATCH"' EXIT
export NONSMOOTH_CM="$CM" NGSPICE TIME_LIMIT SCRATCH

cd "$top" || exit 2 # names in the list are without spaces, whatever stands before them
list >"$SCRATCH/list"
for n in "$@"; do echo "$n"; done >"$SCRATCH/names"
[ $# -eq 0 ] && echo >"$SCRATCH/names"
: >"$SCRATCH/verdicts"
grep -F -f "$SCRATCH/names" "$SCRATCH/list" | cut -d' ' -f1,2 |
    xargs -P "${JOBS:-$(nproc)}" -L1 "$here/run.sh" --one >>"$SCRATCH/verdicts" # at its end: none overwrites another
sort "$SCRATCH/verdicts"
! grep -q '^FAIL' "$SCRATCH/verdicts" && grep -q '^ok' "$SCRATCH/verdicts"
