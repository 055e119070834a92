#!/bin/sh
# tests/versions/run.sh - the code models on several versions of ngspice.
#
#     tests/versions/run.sh FOLDER...
#
# FOLDER is one of ngspice: either the tree in which it was configured and built (program src/ngspice; it gets the code
# models that were built there), or one that holds `ngspice`, the program or a script that runs it, and `source`, the tree
# that was configured as it was.  Each gets models of its own in build/versions/VERSION.  The installed ngspice is the first
# one, and the one that others are compared with.
# Verdicts as tests/netlist/run.sh, then tables:
#   versions/V netlists (klu)    the whole of tests/netlist/run.sh; where KLU was configured, a second time with .options klu
#   versions/V points            each of netlists/*.cir takes as many timepoints as on the first ngspice
#   versions/V cpu               the instructions of a timepoint over those of a timepoint of a plain RC circuit, at most 10 %
#                                more than on the first ngspice; counted by valgrind
#   versions/V host              tests/host/session.c with the library of that version
#   versions/V sources           built with another version's PULSE, it refuses a source whose meaning has changed
#   versions/A into B            models of A loaded into B: one line, no crash; also of the same version with another KLU,
#                                CIDER or OSDI
# how: make test-versions wants folders of ngspices, VERSIONS="FOLDER...".  A FOLDER is one of:
# how:   a tree of ngspice in which ./configure and make were run (program src/ngspice): releases are at
# how:     ngspice.sourceforge.io, how they are built stands in their INSTALL (--enable-xspice is needed)
# how:   a folder that holds `ngspice`, a program or a script that runs it, and `source`, a tree (or a link to one) configured as
# how:     it was: for a package of another release of the system, unpacked by dpkg -x, with the source package of that version
# how:     and, for libngspice, `with-library`, a script that runs its arguments with that version's libngspice.so.0
# Environment: JOBS (as tests/netlist/run.sh), TIME_LIMIT (300 s a netlist: it is for what hangs, also beside other work), ONLY
# (verdicts whose name has this, "netlists"), CPU_RUNS (3), NAMES (of tests/netlist/run.sh, "default cases/ errors/"; none: all).
# At the end a table of all of it, one line for each version.
set -u
cd "$(dirname "$0")/../.." || exit 2
top=$PWD
made=$top/build/versions
ONLY=${ONLY:-} NAMES=${NAMES:-}
export TIME_LIMIT="${TIME_LIMIT:-300}"
mkdir -p "$made" && this=$(mktemp -d "$made/run.XXXXXX") || exit 2
trap 'rm -rf "$this"' EXIT
tables=$this/tables
make="make --no-print-directory -s -j$(nproc)"
status=0

# wanted NAME: 1 if the verdict is asked for.
wanted() {
    case "$1" in *"$ONLY"*) return 0 ;; esac
    return 1
}

# verdict NAME REASON: no reason: ok.
verdict() {
    if [ -z "$2" ]; then
        echo "ok versions/$1"
    else
        echo "FAIL versions/$1 $2"
        status=1
    fi
}

version_of() {
    "$1" --version 2>/dev/null </dev/null | sed -n 's/^\*\* ngspice-\([^ ]*\).*/\1/p'
}

# program FOLDER, source FOLDER
program() {
    if [ -x "$1/ngspice" ]; then echo "$1/ngspice"; else echo "$1/src/ngspice"; fi
}

# program_of_tree VERSION TREE: a script that runs it, which is not installed, with ngspice's own code models built beside it.
# shellcheck disable=SC2016 # for the script
program_of_tree() {
    at=$made/$1/program
    mkdir -p "$at/scripts"
    sed -e "s|^\( *codemodel \).*/\(.*\)\.cm\$|\1$2/src/xspice/icm/\2/\2.cm|" -e '/^ *osdi /d' "$2/src/spinit" >"$at/scripts/spinit"
    {
        printf '#!/bin/sh\n: "${SPICE_SCRIPTS:=%s}"\nexport SPICE_SCRIPTS\n' "$at/scripts"
        printf "exec '%s' \"\$@\"\n" "$2/src/ngspice"
    } >"$at/ngspice"
    chmod +x "$at/ngspice"
    echo "$at/ngspice"
}

source_tree() {
    (cd "$1/source" 2>/dev/null || cd "$1" && pwd -P)
}

# models VERSION PROGRAM SOURCE [MAKE'S VARIABLE...]: builds build/versions/VERSION/nonsmooth.cm.
models() {
    at=build/versions/$1 ngspice=$2 tree=$3
    shift 3
    NGSPICE=$ngspice NGSPICE_SRC=$tree codemodels/ngspice-source.sh "$at/ngspice-src" >"$at.log" 2>&1 &&
        $make B="$at" NG="$at/ngspice-src" CM_LIB=build/libnonsmooth.a NGSPICE="$ngspice" NGSPICE_SRC="$tree" "$@" cm >>"$at.log" 2>&1 &&
        cp build/nsc-mlcp codemodels/*.inc "$at"
}

has() {
    grep -q "^#define $2[[:space:]]" "$made/$1/ngspice-src/tree/src/include/ngspice/config.h"
}

# --- one version ---

# netlists VERSION PROGRAM LABEL [LINE]
netlists() {
    name="$1 netlists$3"
    wanted "$name" || return
    log=$made/$1/netlists$(echo "$3" | tr -d ' ')
    rm -rf "$log.runs"
    # shellcheck disable=SC2086 # words
    NONSMOOTH_CM=$made/$1/nonsmooth.cm NGSPICE=$2 LINE=${4:-} KEEP=$log.runs tests/netlist/run.sh $NAMES >"$log" 2>&1
    passed=$(grep -c '^ok' "$log") failed=$(grep -c '^FAIL' "$log")
    grep '^FAIL' "$log"
    echo "$1 $(echo "${3:-sparse}" | tr -d ' ') $passed $failed" >>"$tables.netlists"
    verdict "$name" "$([ "$failed" = 0 ] && [ "$passed" -gt 0 ] || echo "$failed of $((passed + failed)) failed: $log")"
}

# points VERSION LABEL: "NETLIST points", from the runs that netlists() kept.
points() {
    for f in netlists/*.cir; do
        n=$(basename "$f" .cir)
        sed -n "s/^No. of Data Rows : \\([0-9]*\\).*/$n \\1/p" "$made/$1/netlists$2.runs/${n}_default/out"
    done
}

compare_points() {
    name="$1 points${2:+ ($2)}"
    wanted "$name" && [ -d "$made/$1/netlists$2.runs" ] && [ -d "$made/$first/netlists.runs" ] || return
    points "$first" '' >"$this/points.first"
    points "$1" "$2" >"$this/points.this"
    why=$([ -s "$this/points.first" ] || echo 'no points'
        diff "$this/points.first" "$this/points.this" | grep '^[<>]' | head -n 4 | tr '\n' ' ')
    echo "$1 $([ -z "$why" ] && echo same || echo DIFFER)" >>"$tables.points"
    verdict "$name" "$why"
}

# rc.cir and ours.cir, with SHORT and LONG microseconds and as many points; TIMED for CPU times.
SHORT=5000 LONG=25000 TIMED=200000
write_long_runs() {
    for us in $SHORT $LONG $TIMED; do
        cat >"$this/rc$us.cir" <<END
* a plain RC circuit
V1 a 0 sin(0 10 50)
R1 a b 1k
C1 b 0 1u
.tran 1u ${us}u 0 1u
.control
save v(b)
run
quit 0
.endc
.end
END
        cat >"$this/ours$us.cir" <<END
* a rectifier on the same grid
V1 a 0 sin(0 10 50)
R1 a b 1k
AD1 b c dmod
C1 c 0 1u
R2 c 0 10k
AOPT 0 opts
.model dmod ideal_diode
.model opts nonsmooth(points="grid" corners=0)
.tran 1u ${us}u 0 1u
.control
save v(c)
run
quit 0
.endc
.end
END
    done
}

# load_in DIR MODELS: makes the folder new, with a .spiceinit that loads MODELS.
load_in() {
    rm -rf "$1" && mkdir -p "$1" && echo "codemodel '$2'" >"$1/.spiceinit"
}

# run_in DIR PROGRAM: run.cir there, its text in out.
run_in() {
    (cd "$1" && HOME=$1 exec timeout 60 "$2" -b run.cir >out 2>&1 </dev/null)
}

# spent PROGRAM NETLIST FOLDER: CPU time of the user's side of one run, s.
spent() {
    cd "$3" && { (HOME=$3 exec "$1" -b "$2" >out 2>&1 </dev/null) && times; } | tail -n 1 | sed 's/[ms]/ /g' | awk '{ print 60 * $1 + $2 }'
}

# counted PROGRAM NETLIST FOLDER: instructions of one run.
counted() {
    (cd "$3" && HOME=$3 exec valgrind --tool=callgrind --callgrind-out-file=/dev/null --trace-children=yes "$1" -b "$2" 2>&1 </dev/null) |
        sed -n 's/^==[0-9]*== Collected : //p' | tail -n 1
}

# instructions PROGRAM FOLDER: of a timepoint of ours, of one of RC: what the longer run takes more than the shorter one, so without ngspice's start.
instructions() {
    for circuit in ours rc; do
        for us in $LONG $SHORT; do counted "$1" "$this/$circuit$us.cir" "$2"; done
    done | awk -v points=$((LONG - SHORT)) '{ n[NR] = $1 } END { print (n[1] - n[2]) / points, (n[3] - n[4]) / points }'
}

# seconds PROGRAM FOLDER: least CPU times of ours and of RC.
seconds() {
    # shellcheck disable=SC2034 # counts
    for k in $(seq "${CPU_RUNS:-3}"); do
        echo "$(spent "$1" "$this/ours$TIMED.cir" "$2") $(spent "$1" "$this/rc$TIMED.cir" "$2")"
    done | awk '{ for (k = 1; k <= 2; k++) if (NR == 1 || $k < least[k]) least[k] = $k } END { print least[1], least[2] }'
}

# Instructions decide: each run has the same number of them, on any processor and beside any other program.  CPU times
# of one binary differ by more than 10 % from run to run; they are printed, and decide nothing.
cpu() {
    name="$1 cpu"
    wanted "$name" || return
    dir=$made/$1/cpu
    load_in "$dir" "$made/$1/nonsmooth.cm"
    found="$(instructions "$2" "$dir") $(seconds "$2" "$dir")"
    ratio=$(echo "$found" | awk '{ printf "%.3f", ($2 > 0 ? $1 / $2 : 0) }')
    [ "$1" != "$first" ] || first_ratio=$ratio
    echo "$1 $ratio $found" >>"$tables.cpu"
    verdict "$name" "$(awk -v r="$ratio" -v f="${first_ratio:-0}" \
        'BEGIN { if (!(r > 0 && f > 0 && r <= 1.1 * f)) print "ratio of instructions " r ", on the first ngspice " f }')"
}

# host VERSION PROGRAM FOLDER: the program of libngspice, with the library of this version.
host() {
    name="$1 host"
    wanted "$name" && [ -x "$top/build/tests/host/session" ] || return
    if [ "$1" = "$first" ]; then with='env'; else with=$3/with-library; fi
    [ "$with" = env ] || [ -x "$with" ] || return
    dir=$made/$1/host
    mkdir -p "$dir"
    (cd "$dir" && HOME=$dir timeout 600 "$with" "$top/build/tests/host/session" "$made/$1/nonsmooth.cm" >out 2>err </dev/null)
    rc=$?
    good=$(grep -c '^ok' "$dir/out")
    why=
    [ $rc = 0 ] && [ "$good" = 10 ] || why="status $rc, $good of 10 steps: $dir/out"
    echo "$1 $([ -z "$why" ] && echo yes || echo FAILED)" >>"$tables.host"
    verdict "$name" "$why"
}

# A pulse whose width is not given, by models that were built for the PULSE of another version.
sources() {
    name="$1 sources"
    wanted "$name" || return
    major=$(echo "$1" | cut -c1-2)
    other=39
    [ "$major" -lt 46 ] && other=47
    dir=$made/$1/sources
    rm -rf "$dir" && mkdir -p "$dir"
    cp -al "$made/$1/obj" "$made/$1/cm" "$made/$1/flags" "$dir"
    rm -f "$dir/obj/codemodels/bridge/sources.o"
    $make B="build/versions/$1/sources" NG="build/versions/$1/ngspice-src" CM_LIB=build/libnonsmooth.a \
        PULSE_OF="$other" "build/versions/$1/sources/nonsmooth.cm" >"$dir/log" 2>&1 || { verdict "$name" "not built: $dir/log"; return; }
    cat >"$dir/run.cir" <<'END'
* pulse without width
VP a 0 pulse(0 1 1u 1n 1n)
AD1 a b dmod
R1 b 0 1k
.model dmod ideal_diode
.tran 1u 100u
.control
run
quit 0
.endc
.end
END
    echo "codemodel '$dir/nonsmooth.cm'" >"$dir/.spiceinit"
    run_in "$dir" "$2"
    n=$(grep -c '^nonsmooth: vp: at t = .* s ngspice gives this source .* expected ' "$dir/out")
    verdict "$name" "$([ "$n" = 1 ] || echo "$n lines name the source: $dir/out")"
}

# --- models of one version in another one ---

# into MODELS LABEL VERSION PROGRAM
into() {
    name="$2 into $3"
    wanted "$name" || return
    dir=$this/into
    load_in "$dir" "$1"
    cat >"$dir/run.cir" <<'END'
* models of another version
VP a 0 1
AD1 a b dmod
AS1 b c a 0 smod
R1 c 0 1k
.model dmod ideal_diode(vf=0.5)
.model smod ideal_switch(ron=1)
.tran 1u 100u
.control
run
quit 0
.endc
.end
END
    run_in "$dir" "$4"
    rc=$?
    n=$(grep -c '^nonsmooth: ' "$dir/out")
    said=$(grep -c '^nonsmooth: nonsmooth.cm.* was loaded by an' "$dir/out")
    reason=
    [ "$n $said" = '1 1' ] || reason="$n lines of ours, $said refuse: $(grep '^nonsmooth' "$dir/out" | head -n 1)"
    [ $rc -le 128 ] || reason="crashed: signal $((rc - 128))"
    case "$reason" in '') mark=refused ;; crash*) mark=CRASHED ;; *) mark=TAKEN ;; esac
    echo "$2 $3 $mark" >>"$tables.into"
    verdict "$name" "$reason"
}

# other_choice VERSION PROGRAM FEATURE: models for the same version without FEATURE, or with it.
other_choice() {
    wanted "$1 without $3 into $1" || return
    has "$1" "$3" || return
    at=$made/$1/without-$3
    rm -rf "$at" && mkdir -p "$at/ngspice-src" || return
    cp -al "$made/$1/ngspice-src/." "$at/ngspice-src/"
    config=src/include/ngspice/config.h
    rm -f "$at/ngspice-src/tree/$config"
    sed "s/^#define $3[[:space:]].*/\\/* no $3 *\\//" "$made/$1/ngspice-src/tree/$config" >"$at/ngspice-src/tree/$config"
    $make CFLAGS=-O0 B="build/versions/$1/without-$3" NG="build/versions/$1/without-$3/ngspice-src" \
        CM_LIB=build/libnonsmooth.a "build/versions/$1/without-$3/nonsmooth.cm" >"$at/log" 2>&1 || {
        verdict "$1 without $3 into $1" "not built: $at/log"
        return
    }
    into "$at/nonsmooth.cm" "$1 without $3" "$1" "$2"
    rm -rf "$at/ngspice-src"
}

# --- all ---

: >"$this/list"
: >"$tables.built"
installed=$(command -v ngspice)
first=$(version_of "${installed:-false}")
if [ -n "$first" ]; then
    echo "$first $installed $top/build/ngspice-src/tree -" >>"$this/list"
fi
for folder; do
    folder=$(cd "$folder" 2>/dev/null && pwd -P || echo "$folder")
    p=$(program "$folder")
    v=$(version_of "$p")
    if [ -z "$v" ]; then
        verdict "$folder" "no ngspice there: neither $folder/ngspice nor $folder/src/ngspice runs"
    else
        [ "$p" = "$folder/ngspice" ] || p=$(program_of_tree "$v" "$folder")
        echo "$v $p $(source_tree "$folder") $folder" >>"$this/list"
    fi
done

write_long_runs
while read -r v p tree folder; do
    mkdir -p "$made/$v"
    models "$v" "$p" "$tree" || {
        verdict "$v" "models are not built: $made/$v.log"
        continue
    }
    echo "$v $p" >>"$tables.built"
    netlists "$v" "$p" ''
    compare_points "$v" ''
    if has "$v" KLU; then
        netlists "$v" "$p" ' klu' '.options klu'
        compare_points "$v" klu
    fi
    cpu "$v" "$p"
    host "$v" "$p" "$folder"
    sources "$v" "$p"
    for feature in KLU CIDER OSDI WITH_PSS RFSPICE; do other_choice "$v" "$p" $feature; done
done <"$this/list"
while read -r a _; do
    while read -r b p; do
        [ "$a" = "$b" ] || into "$made/$a/nonsmooth.cm" "$a" "$b" "$p"
    done <"$tables.built"
done <"$tables.built"

# cell FILE VERSION: the last words of its lines for VERSION, each once; without one, "-".
cell() {
    awk -v version="$2" '$1 == version && !seen[$NF]++ { words = words (words ? "," : "") $NF } END { print words ? words : "-" }' "$1" 2>/dev/null
}

# netlists_cell FILE VERSION SOLVER
netlists_cell() {
    awk -v version="$2" -v solver="$3" '$1 == version && $2 == solver { said = $3 " passed, " $4 " failed" } END { print said ? said : "-" }' "$1"
}

# Of what was not asked for (ONLY), or is not there (KLU before 42), "-".
touch "$tables.netlists" "$tables.points" "$tables.cpu" "$tables.host" "$tables.into"
# row VERSION SPARSE KLU POINTS RATIO SHARE HOST INTO
row() {
    printf '%-8s %-23s %-23s %-7s %-13s %-15s %-11s %s\n' "$@"
}

echo
row version Sparse KLU points 'instructions' "of first's" libngspice 'its models in others,'
row '' '' '' '' 'over RC' '' '' 'or in its other choices'
while read -r v _; do
    ratio=$(awk -v v="$v" '$1 == v { print $2 }' "$tables.cpu")
    row "$v" "$(netlists_cell "$tables.netlists" "$v" sparse)" "$(netlists_cell "$tables.netlists" "$v" klu)" "$(cell "$tables.points" "$v")" "${ratio:--}" \
        "$(echo "${ratio:-0} ${first_ratio:-0}" | awk '{ if ($1 * $2 > 0) printf "%.1f %%\n", 100 * $1 / $2; else print "-" }')" "$(cell "$tables.host" "$v")" \
        "$(awk -v v="$v" '$1 == v { n++; refused += $NF == "refused" } END { print n ? refused " of " n " refused" : "-" }' "$tables.into")"
done <"$tables.built"
awk 'NR == 1 { print "\nversion  instructions of a timepoint, ours and RC; CPU time of 200,000 points, ours and RC" }
    { printf "%-8s %9.0f %9.0f %9.2f s %9.2f s\n", $1, $3, $4, $5, $6 }' "$tables.cpu"
grep -v 'refused$' "$tables.into"
exit $status
