#!/bin/sh
# tests/source.sh - codemodels/ngspice-source.sh: which tree it takes for NGSPICE and NGSPICE_SRC, and what it refuses in one line.
#
# Programs and trees are made up: a script that answers --version as ngspice 46 does, and a tree with the files that are looked at.
cd "$(dirname "$0")/.." || exit 1
made=$PWD/build/source
rm -rf "$made"
mkdir -p "$made/bin" || exit 1
status=0

# tree FOLDER VERSION [LINE]: one that is configured and has its cmpp; LINE of its configuration.
tree() {
    mkdir -p "$1/src/xspice/icm" "$1/src/xspice/cmpp" "$1/src/include/ngspice" || exit 1
    : >"$1/src/xspice/icm/dlmain.c"
    printf '#!/bin/sh\n' >"$1/src/xspice/cmpp/cmpp" && chmod +x "$1/src/xspice/cmpp/cmpp"
    printf '%s\n' "#define PACKAGE_VERSION \"$2\"" "${3:-#define XSPICE 1}" >"$1/src/include/ngspice/config.h"
    : >"$1/config.status"
}

# program FILE VERSION
program() {
    printf '#!/bin/sh\nprintf "******\\n** ngspice-%s : Circuit level simulation program\\n"\n' "$2" >"$1" && chmod +x "$1"
}

# get_source NGSPICE NGSPICE_SRC
get_source() {
    NGSPICE=$1 NGSPICE_SRC=$2 timeout 60 codemodels/ngspice-source.sh "$made/got" >"$made/said" 2>&1 </dev/null
}

verdict() {
    if [ -z "$2" ]; then echo "ok $1"; else
        echo "FAIL $1: $2"
        sed 's/^/    /' "$made/said"
        status=1
    fi
}

# refused NAME NGSPICE NGSPICE_SRC LINE: with that line alone, and what was taken before is still there.
refused() {
    get_source "$2" "$3"
    got=$?
    verdict "refused: $1" "$([ $got = 1 ] || echo "status $got, expected 1"
        [ "$(cat "$made/said")" = "ngspice source: $4" ] || echo "another line than: $4"
        [ ! -f "$made/taken" ] || [ -f "$made/got/stamp" ] || echo 'what was taken before is gone')"
}

# taken NAME NGSPICE NGSPICE_SRC TEXT: its configuration has TEXT.
taken() {
    get_source "$2" "$3"
    got=$?
    : >"$made/taken"
    verdict "taken: $1" "$([ $got = 0 ] || echo "status $got"
        grep -q "$4" "$made/got/tree/src/include/ngspice/config.h" || echo "not this tree"
        [ -f "$made/got/tree/src/xspice/icm/dlmain.c" ] || echo 'no dlmain.c')"
}

program "$made/bin/ngspice" 46
tree "$made/46" 46
tree "$made/45" 45.2
tree "$made/plain" 46 '/* no XSPICE */'
mkdir "$made/empty"
mkdir -p "$made/out/src/include/ngspice" "$made/out/src/xspice/cmpp" # configured beside its source
cp "$made/46/src/xspice/cmpp/cmpp" "$made/out/src/xspice/cmpp"
echo 'top_srcdir = ../46' >"$made/out/Makefile"

taken 'a tree' "$made/bin/ngspice" "$made/46" '"46"'
verdict 'a tree that was taken is not taken again' "$(get_source "$made/bin/ngspice" "$made/46" || echo 'it fails'
    [ ! -s "$made/said" ] || echo 'it says something')"
refused 'no program' "$made/nothing" "$made/46" "there is no program $made/nothing: NGSPICE=FILE names one"
refused 'a folder' "$made/46" '' "NGSPICE=$made/46 is a folder: give the program in it, $made/46/src/ngspice for example"
refused 'another program' /bin/true '' '/bin/true is no ngspice: its --version names none'
refused 'a program without a tree' "$made/bin/ngspice" '' \
    "$made/bin/ngspice is of no package, and not where it was built: give the tree it was made from as NGSPICE_SRC=dir"
refused 'no folder' "$made/bin/ngspice" "$made/nothing" "NGSPICE_SRC=$made/nothing is no folder"
refused 'a folder without a source' "$made/bin/ngspice" "$made/empty" "NGSPICE_SRC=$made/empty holds no src/xspice/icm/dlmain.c"
refused 'a tree of another version' "$made/bin/ngspice" "$made/45" \
    "the source is ngspice 45.2 but $made/bin/ngspice is ngspice 46: they must be the same"
refused 'a tree without XSPICE' "$made/bin/ngspice" "$made/plain" \
    "$made/plain was configured without --enable-xspice: that ngspice takes no code models"
refused 'a folder that is not configured' "$made/bin/ngspice" "$made/out" "NGSPICE_SRC=$made/out is not configured"
tree "$made/46" 46 '#define XSPICE 1 /* and KLU */'
taken 'a tree that was configured anew' "$made/bin/ngspice" "$made/46" 'and KLU'
program "$made/bin/ngspice" 47
refused 'a program that was built anew' "$made/bin/ngspice" "$made/46" \
    "the source is ngspice 46 but $made/bin/ngspice is ngspice 47: they must be the same"
program "$made/45/src/ngspice" 45.2
taken 'the tree around a program' "$made/45/src/ngspice" '' '"45.2"'
program "$made/bin/ngspice" 46
printf '%s\n' '#define PACKAGE_VERSION "46"' '#define XSPICE 1 /* beside */' >"$made/out/src/include/ngspice/config.h"
taken 'a tree configured beside its source' "$made/bin/ngspice" "$made/out" beside
# As it was released: its configure writes config.h.
tree "$made/fresh" 46
mv "$made/fresh/src/include/ngspice/config.h" "$made/fresh/config"
printf '#!/bin/sh\ncp config src/include/ngspice/config.h\n' >"$made/fresh/configure" && chmod +x "$made/fresh/configure"
taken 'a tree that is not configured' "$made/bin/ngspice" "$made/fresh" '"46"'
verdict 'nothing fails on the way' "$(grep -v '^ngspice source: ' "$made/said")"
# A mirror without source packages: an apt-get that says so.
printf '%s\n' '#!/bin/sh' 'case "$*" in *source*) echo "E: Failed to fetch ngspice.dsc  404" >&2; exit 100 ;; esac' >"$made/bin/apt-get" && chmod +x "$made/bin/apt-get"
PATH=$made/bin:$PATH codemodels/source-package.sh "$made/package" ngspice 46 >"$made/said" 2>&1 </dev/null
got=$?
verdict 'refused: no source package' "$([ $got = 1 ] || echo "status $got, expected 1"
    [ "$(grep -c . "$made/said")" = 2 ] || echo 'not two lines'
    grep -q '^source package: apt has no source of ngspice 46: Failed to fetch ngspice.dsc  404 (' "$made/said" || echo 'the cause is not said')"
rm -rf "$made"
exit $status
