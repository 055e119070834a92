#!/bin/sh
# tests/mutants.sh - small changes to src/, one at a time: does a test notice?
#
#     tests/mutants.sh COUNT SEED
#
# `make mutants` calls it, with everything built in build/mutants.  COUNT mutants, picked by SEED among all candidates
# (tests/mutants/candidates.awk); those that do not compile, or to the same object, are replaced by others.  For each
# one its file is compiled and the library linked anew.  Then run, until one fails: the test programs that call the
# changed function, of its room first, the quickest first; a few of them again under valgrind; the tests of nsc-mlcp
# and the netlists through ngspice.  A program that takes ten times as long as it does fails.
# Printed: each mutant that lives, and how many were noticed.  Those of tests/mutants/accepted, lines
# "FILE | BEFORE | AFTER | REASON", are printed with their reason.  Status 0: 85 of 100 were noticed.
# Environment: QUICK=yes leaves out the netlists, valgrind, and programs of more than a second.
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C OPENBLAS_NUM_THREADS=1
dir=build/mutants
made=$dir/made
tab=$(printf '\t')

# objects MUTANT: of the library, the mutant's in place of its original.
objects() {
    file=$(cut -f2 "$made/$1/change")
    find src -name '*.c' ! -path 'src/tool/*' ! -path "$file" | sed "s|\(.*\)\.c$|$dir/obj/\1.o|"
    case $file in src/tool/*) ;; *) echo "$made/$1/mutant.o" ;; esac
}

# compile MUTANT: mutant.o is there if it is another object.
compile() {
    at=$made/$1
    IFS=$tab read -r _ file line _ before after <"$at/change"
    copy=$at/$(basename "$file")
    AFTER=$after awk -v line="$line" '
        FNR == line {match($0, /^ */); $0 = substr($0, 1, RLENGTH) ENVIRON["AFTER"]} {print}' "$file" >"$copy"
    # shellcheck disable=SC2086 # options
    $CC $CFLAGS -iquote "$(dirname "$file")" -c "$copy" -MF /dev/null -o "$at/mutant.o" 2>/dev/null ||
        rm -f "$at/mutant.o"
    ! cmp -s "$at/mutant.o" "$dir/obj/${file%.c}.o" || rm -f "$at/mutant.o"
    rm -f "$copy"
}

# limited SECONDS COMMAND...: with so much CPU time.
# shellcheck disable=SC3045 # dash and bash have these
limited() (
    ulimit -t "$1"
    ulimit -v 4000000
    shift
    timeout 600 "$@" >/dev/null 2>&1 </dev/null
)

# noticed_by MUTANT: prints what notices it, or nothing.
noticed_by() {
    at=$made/$1
    file=$(cut -f2 "$at/change") function=$(cut -f4 "$at/change")
    room=$(echo "$file" | cut -d/ -f2)
    awk -F'\t' -v file="$file" -v f="$function" '$1 == file && $2 == f {print $3}' "$dir/calls.list" >"$at/calling"
    awk -v room="/unit/$room/" 'NR == FNR {calls[$1] = 1; next} $1 in calls {print !index($1, room), $2, $1}' \
        "$at/calling" "$dir/times" | sort -k1,1n -k2,2n >"$at/programs"
    # shellcheck disable=SC2046,SC2086 # objects, options
    case $file in
    src/tool/*) ;;
    *) $CC -shared -Wl,-soname,libnonsmooth-test.so $WRAP $(objects "$1") -o "$at/libnonsmooth-test.so" $LIBS ;;
    esac
    while read -r _ seconds program; do
        [ "${QUICK:-no}" = no ] || [ "$seconds" -lt 100 ] || continue
        LD_LIBRARY_PATH=$at limited $((10 * seconds / 100 + 5)) "$program" || { echo "$program" && return; }
    done <"$at/programs"
    [ "${QUICK:-no}" = no ] || return
    head -n 4 "$at/programs" >"$at/few"
    while read -r _ seconds program; do
        [ "$seconds" -lt 100 ] || continue
        LD_LIBRARY_PATH=$at limited $((seconds + 60)) valgrind -q --leak-check=full --errors-for-leak-kinds=definite \
            --error-exitcode=9 "$program" || { echo "valgrind $program" && return; }
    done <"$at/few"
    tool=$dir/obj/src/tool/nsc_mlcp.o
    case $file in src/tool/*) tool=$at/mutant.o ;; esac
    # shellcheck disable=SC2046,SC2086
    $CC $tool $(objects "$1") -o "$at/nsc-mlcp" $LIBS
    limited 60 tests/tool/run.sh "$at/nsc-mlcp" || { echo tests/tool/run.sh && return; }
    case $file in src/tool/*) return ;; esac
    # shellcheck disable=SC2046,SC2086
    $CC -shared -Wl,--version-script=codemodels/nonsmooth.map $CM_OBJ $(objects "$1") -o "$at/nonsmooth.cm" $CM_LIBS
    NONSMOOTH_CM=$at/nonsmooth.cm JOBS=1 tests/netlist/run.sh >"$at/netlists" 2>&1 ||
        echo "netlists: $(grep -m1 '^FAIL' "$at/netlists")"
}

case $1 in
--compile) compile "$2" && exit ;;
--run)
    noticed_by "$2" >"$made/$2/noticed"
    rm -f "$made/$2/libnonsmooth-test.so" "$made/$2/nonsmooth.cm" "$made/$2/nsc-mlcp"
    exit
    ;;
esac
most=$1 seed=$2
rm -rf "$made"
mkdir -p "$made" "$dir/called"

# What each program calls, and how long it takes, in 1/100 s of CPU time.
for program in "$dir"/tests/unit/*/* "$dir"/tests/property/* "$dir"/tests/reference/* "$dir"/tests/fault/*; do
    [ -x "$program" ] || continue
    name=$(echo "${program#"$dir"/tests/}" | tr / .)
    log=$dir/called/$name
    [ -z "$(find "$log.time" -newer "$program" -newer "$dir/calls/libnonsmooth-test.so" 2>/dev/null)" ] || continue
    rm -f "$log.time"
    if (CALLS=$log LD_LIBRARY_PATH=$dir/calls "$program" >/dev/null 2>&1 </dev/null && times >"$log.times"); then
        awk -v program="$program" 'NR == 2 {split($1, t, /[ms]/); print program, int(100 * (60 * t[1] + t[2])) + 1}' \
            "$log.times" >"$log.time"
    else
        echo "mutants: $program fails without any change, and is left out" >&2
    fi
done
cat "$dir"/called/*.time >"$dir/times"
cat "$dir"/called/*.time | while read -r program _; do
    name=$(echo "${program#"$dir"/tests/}" | tr / .)
    sed "s|\$| $program|" "$dir/called/$name"
done >"$dir/called.all"
cut -d' ' -f1 "$dir/called.all" | sort -u >"$dir/offsets"
addr2line -f -e "$dir/calls/libnonsmooth-test.so" <"$dir/offsets" | paste - - >"$dir/functions"
paste "$dir/offsets" "$dir/functions" |
    awk -F'\t' -v OFS='\t' '
        NR == FNR {sub(/.*\/src\//, "src/", $3); sub(/:.*/, "", $3); sub(/\..*/, "", $2); at[$1] = $3 OFS $2; next}
        {split($0, part, " "); print at[part[1]], part[2]}' - "$dir/called.all" >"$dir/calls.list"

find src -name '*.c' | sort | xargs awk -f tests/mutants/candidates.awk >"$dir/candidates"
awk -v seed="$seed" -v most=$((2 * most + 20)) -f tests/mutants/pick.awk "$dir/candidates" >"$dir/picked"
echo "seed $seed, $(wc -l <"$dir/candidates") candidates"

# Compiled until there are enough.
valid=0 next=0
: >"$dir/valid"
while [ "$valid" -lt "$most" ] && [ $next -lt "$(wc -l <"$dir/picked")" ]; do
    last=$((next + most - valid))
    while [ $next -lt $last ]; do
        next=$((next + 1))
        mkdir -p "$made/$next"
        sed -n "${next}p" "$dir/picked" >"$made/$next/change"
        echo $next
    done >"$dir/batch"
    next=$last
    xargs -P "$(nproc)" -n1 "$0" --compile <"$dir/batch"
    while read -r k; do [ ! -f "$made/$k/mutant.o" ] || echo "$k"; done <"$dir/batch" >>"$dir/valid"
    valid=$(wc -l <"$dir/valid")
done

xargs -P "$(nproc)" -n1 "$0" --run <"$dir/valid"

while read -r k; do
    IFS=$tab read -r _ file line function before after <"$made/$k/change"
    if [ -s "$made/$k/noticed" ]; then
        echo noticed
        continue
    fi
    reason=
    [ ! -f tests/mutants/accepted ] || reason=$(FILE=$file BEFORE=$before AFTER=$after awk -F' [|] ' '
        $1 == ENVIRON["FILE"] && $2 == ENVIRON["BEFORE"] && $3 == ENVIRON["AFTER"] {print $4; exit}' \
        tests/mutants/accepted)
    echo lives
    printf '%s:%s %s\n    %s\n    %s\n%s' "$file" "$line" "$function" "$before" "$after" "${reason:+    because: $reason
}" >&2
done <"$dir/valid" 2>"$dir/living" >"$dir/verdicts"
cat "$dir/living"
awk '/noticed/ {n++} END {print n + 0 " of " NR " noticed"; exit !(NR && n >= 0.85 * NR)}' "$dir/verdicts"
