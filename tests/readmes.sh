#!/bin/sh
# tests/readmes.sh - what any README names is there: files, folders, functions, targets and variables of make,
# parameters of the models, options of programs, lines of code that src/README.md quotes.  Rooms have a README of at
# most 40 lines, the first one has at most 200.
#
# A file is there if a path of the repository ends in its name; one that README's reader makes: see `readers`.
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
readers='buck.cir example.c step.txt'
status=0

find . \( -path ./build -o -path ./.git \) -prune -o -print | sed 's|^\./||' >"$tmp/paths"
find include src codemodels tests netlists -type f ! -name README.md -exec cat {} + |
    tr -cs 'A-Za-z0-9_' '\n' | sort -u >"$tmp/words"
find include src codemodels tests -name '*.[ch]' -exec grep -ohE '[A-Za-z0-9_]+\(' {} + | sort -u >"$tmp/functions"
for model in ideal_diode ideal_switch nonsmooth; do
    awk -v model=$model '/^Parameter_Name:/ {for (k = 2; k <= NF; k++) print model "." $k}' codemodels/$model/ifspec.ifs
done >"$tmp/parameters"

# there README KIND NAME
there() {
    case $2 in
    link) [ -e "$(dirname "$1")/$3" ] ;;
    file | folder)
        case " $readers " in *" $3 "*) return 0 ;; esac
        awk -v name="/$3" '{p = "/" $0; at = length(p) - length(name) + 1} at > 0 && substr(p, at) == name {found = 1; exit}
            END {exit !found}' "$tmp/paths"
        ;;
    function) grep -qxF "$3(" "$tmp/functions" ;;
    name) grep -qxF "$3" "$tmp/words" ;;
    target) grep -qE "^$3:" Makefile ;;
    variable) grep -qE "\b$3\b" Makefile ;;
    parameter) grep -qxF "$3" "$tmp/parameters" ;;
    flag) grep -rqF -e "$3" src tests codemodels --include='*.c' --include='*.sh' ;;
    esac
}

for readme in $(find . \( -path ./build -o -path ./.git \) -prune -o -name README.md -print | sed 's|^\./||' | sort); do
    awk -f tests/readmes/names.awk "$readme" | sort -u >"$tmp/names"
    missing=0
    while read -r kind name; do
        there "$readme" "$kind" "$name" && continue
        echo "FAIL $readme names a $kind that is not there: $name"
        missing=1 status=1
    done <"$tmp/names"
    [ $missing = 1 ] || echo "ok $readme: $(wc -l <"$tmp/names") names"
done

awk '/^```/ {on = $0 == "```c"; next} on' src/README.md >"$tmp/quoted"
while read -r line; do
    grep -rqF -e "$line" src codemodels --include='*.c' && continue
    echo "FAIL src/README.md quotes a line that is not there: $line"
    status=1
done <"$tmp/quoted"

awk '/^    [0-9.]+ .s +exact:/ {sub(/.*exact:/, "* says: exact:"); print $0 ","}' src/README.md >"$tmp/counts"
awk '/^\* says: /' tests/netlist/cases/tour.cir | cmp -s - "$tmp/counts" || {
    echo "FAIL src/README.md shows other counts than tests/netlist/cases/tour.cir expects"
    status=1
}

# lines README MOST: it is there and has at most so many.
lines() {
    if [ ! -f "$1" ]; then
        echo "FAIL $1 is missing"
        status=1
    elif [ "$(wc -l <"$1")" -gt "$2" ]; then
        echo "FAIL $1 has $(wc -l <"$1") lines, more than $2"
        status=1
    else
        echo "ok $1: at most $2 lines"
    fi
}
lines README.md 200
for room in src/*/; do
    lines "${room}README.md" 40
done
for room in codemodels/bridge include tests/bench; do
    lines $room/README.md 120
done
exit $status
