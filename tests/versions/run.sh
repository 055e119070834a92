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
#   versions/V cpu               the instructions of a long run (where perf does not count them: its CPU time) over those of a
#                                plain RC circuit with as many points, at most 10 % more than on the first ngspice (least of several runs)
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
# Environment: JOBS, TIME_LIMIT (as tests/netlist/run.sh), ONLY (verdicts whose name has this, "netlists"), CPU_RUNS (5),
# NAMES (of tests/netlist/run.sh, "default cases/ errors/ cookbook/ README"; none: all).
set -u
cd "$(dirname "$0")/../.." || exit 2
top=$PWD
made=$top/build/versions
ONLY=${ONLY:-} NAMES=${NAMES:-}
mkdir -p "$made" && this=$(mktemp -d "$made/run.XXXXXX") || exit 2
trap 'rm -rf "$this"' EXIT
tables=$this/tables
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
        make --no-print-directory -s B="$at" NG="$at/ngspice-src" CM_LIB=build/libnonsmooth.a NGSPICE="$ngspice" NGSPICE_SRC="$tree" \
            "$@" cm >>"$at.log" 2>&1 && cp build/nsc-mlcp codemodels/*.inc "$at"
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
    echo "$1$3 $passed $failed" >>"$tables.netlists"
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
    verdict "$name" "$([ -s "$this/points.first" ] || echo 'no points'
        diff "$this/points.first" "$this/points.this" | grep '^[<>]' | head -n 4 | tr '\n' ' ')"
}

# Both have 200,000 points.
write_long_runs() {
    cat >"$this/rc.cir" <<'END'
* a plain RC circuit
V1 a 0 sin(0 10 50)
R1 a b 1k
C1 b 0 1u
.tran 1u 200m 0 1u
.control
save v(b)
run
quit 0
.endc
.end
END
    cat >"$this/ours.cir" <<'END'
* a rectifier on the same grid
V1 a 0 sin(0 10 50)
R1 a b 1k
AD1 b c dmod
C1 c 0 1u
R2 c 0 10k
AOPT 0 opts
.model dmod ideal_diode
.model opts nonsmooth(points="grid" corners=0)
.tran 1u 200m 0 1u
.control
save v(c)
run
quit 0
.endc
.end
END
}

# load_in DIR MODELS: makes the folder new, with a .spiceinit that loads MODELS.
load_in() {
    rm -rf "$1" && mkdir -p "$1" && echo "codemodel '$2'" >"$1/.spiceinit"
}

# run_in DIR PROGRAM: run.cir there, its text in out.
run_in() {
    (cd "$1" && HOME=$1 exec timeout 60 "$2" -b run.cir >out 2>&1 </dev/null)
}

# spent PROGRAM NETLIST FOLDER: CPU time of the user's side of one run, s, and its instructions, 1 where perf cannot count them.
spent() {
    cd "$3" || return
    rm -f counted
    # shellcheck disable=SC2086 # words
    { (HOME=$3 exec $counter "$1" -b "$2" >out 2>&1 </dev/null) && times; } | tail -n 1 | sed 's/[ms]/ /g' | awk '{ printf "%s ", 60 * $1 + $2 }'
    { cat counted 2>/dev/null && echo 1,,instructions; } | sed -n 's/,.*instructions.*//p' | head -n 1
}

# ratios VERSION PROGRAM: of the least times, those times, ratio of the least instructions.
ratios() {
    dir=$made/$1/cpu
    load_in "$dir" "$made/$1/nonsmooth.cm"
    # shellcheck disable=SC2034 # counts
    for k in $(seq "${CPU_RUNS:-5}"); do
        echo "$(spent "$2" "$this/ours.cir" "$dir") $(spent "$2" "$this/rc.cir" "$dir")"
    done | awk '{ for (k = 1; k <= 4; k++) if (NR == 1 || $k < least[k]) least[k] = $k }
        END { printf "%.3f %.2f %.2f %.3f\n", least[1] / least[3], least[1], least[3], least[2] / least[4] }'
}

# Instructions decide where they can be counted: times of a busy machine differ by more than 10 %.
cpu() {
    name="$1 cpu"
    wanted "$name" || return
    counter=
    perf stat -e instructions:u true >/dev/null 2>&1 && counter='perf stat -x, -o counted -e instructions:u'
    found=$(ratios "$1" "$2")
    decides=${found%% *}
    [ -z "$counter" ] || decides=${found##* }
    [ "$1" != "$first" ] || first_ratio=$decides
    echo "$1 $found" >>"$tables.cpu"
    verdict "$name" "$(awk -v r="$decides" -v f="${first_ratio:-0}" \
        'BEGIN { if (!(r > 0 && f > 0 && r <= 1.1 * f)) print "ratio " r ", on the first ngspice " f }')"
}

# The program of libngspice, with the library of this version.
host() {
    name="$1 host"
    wanted "$name" && [ -x "$top/build/tests/host/session" ] || return
    if [ "$1" = "$first" ]; then with='env'; else with=$(dirname "$2")/with-library; fi
    [ "$with" = env ] || [ -x "$with" ] || return
    dir=$made/$1/host
    mkdir -p "$dir"
    (cd "$dir" && HOME=$dir timeout 600 "$with" "$top/build/tests/host/session" "$made/$1/nonsmooth.cm" >out 2>err </dev/null)
    rc=$?
    verdict "$name" "$([ $rc = 0 ] && [ "$(grep -c '^ok' "$dir/out")" = 10 ] || echo "status $rc: $dir/out")"
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
    make --no-print-directory -s B="build/versions/$1/sources" NG="build/versions/$1/ngspice-src" CM_LIB=build/libnonsmooth.a \
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
    make --no-print-directory -s B="build/versions/$1/without-$3" NG="build/versions/$1/without-$3/ngspice-src" \
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
    echo "$first $installed $top/build/ngspice-src/tree" >>"$this/list"
fi
for folder; do
    folder=$(cd "$folder" 2>/dev/null && pwd -P || echo "$folder")
    p=$(program "$folder")
    v=$(version_of "$p")
    if [ -z "$v" ]; then
        verdict "$folder" "no ngspice there: neither $folder/ngspice nor $folder/src/ngspice runs"
    else
        [ "$p" = "$folder/ngspice" ] || p=$(program_of_tree "$v" "$folder")
        echo "$v $p $(source_tree "$folder")" >>"$this/list"
    fi
done

write_long_runs
while read -r v p tree; do
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
    host "$v" "$p"
    sources "$v" "$p"
    for feature in KLU CIDER OSDI WITH_PSS RFSPICE; do other_choice "$v" "$p" $feature; done
done <"$this/list"
while read -r a _; do
    while read -r b p; do
        [ "$a" = "$b" ] || into "$made/$a/nonsmooth.cm" "$a" "$b" "$p"
    done <"$tables.built"
done <"$tables.built"

echo
[ ! -f "$tables.netlists" ] || awk 'BEGIN { print "netlists      passed  failed" } { f = $NF; p = $(NF - 1); printf "%-13s %6d %7d\n", NF == 4 ? $1 " " $2 : $1, p, f }' "$tables.netlists"
[ ! -f "$tables.cpu" ] || awk 'BEGIN { print "\nCPU time      ratio    ours      RC  ratio of instructions (1: not counted)" } { printf "%-13s %5.2f %5.2f s %5.2f s %5.3f\n", $1, $2, $3, $4, $5 }' "$tables.cpu"
[ ! -f "$tables.into" ] || awk 'BEGIN { print "\nmodels        loaded into" } { printf "%s\n", $0 }' "$tables.into"
exit $status
