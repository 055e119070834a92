#!/bin/sh
# tests/rooms.sh - the rooms of src/: who uses whom, what must not be, how large they are.
#
#     tests/rooms.sh [check | graph | figures [COMMIT]]
#
# check: a line `ok RULE` or `FAIL RULE` for each rule, the offenders below it; reads the symbols of the objects in
# build/obj, and the sources.  graph: each room and the rooms it uses, in the order of tests/rooms/layers.  figures:
# lines, lengths of functions, tests and assertions; of COMMIT too, where it is there, and how many lines its sources
# have by now.
#
# shellcheck disable=SC2038,SC2317 # no spaces in names of files; functions that rule calls
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
status=0

# symbols FOLDER: of the objects of its present sources.
symbols() {
    find "$1" -name '*.c' | sed 's|\(.*\)\.c$|build/obj/\1.o|' | xargs nm -g -P -A
}

# rule NAME COMMAND...: it holds where the command prints nothing.
rule() {
    name=$1
    shift
    "$@" >"$tmp/said" 2>&1
    if [ -s "$tmp/said" ]; then
        echo "FAIL $name"
        sed 's/^/    /' "$tmp/said"
        status=1
    else
        echo "ok $name"
    fi
}

# read_symbols WHAT FOLDER
read_symbols() {
    symbols "$2" | sort >"$tmp/symbols"
    grep -rE '^#include "[a-z]+/' "$2" >"$tmp/includes"
    awk -v what="$1" -v "root=build/obj/$2/" -f tests/rooms/layers.awk -f tests/rooms/symbols.awk tests/rooms/layers \
        include/nonsmooth/*.h "$tmp/includes" "$tmp/symbols"
}

read_includes() {
    find src codemodels -name '*.[ch]' -exec awk -f tests/rooms/layers.awk -f tests/rooms/includes.awk \
        tests/rooms/layers {} +
}

ngspice_in_src() {
    grep -rniE '#include.*(ngspice|spicelib|cktdefs|mifdefs|cm\.h)' src
}

two_meanings() {
    find src codemodels include -name '*.[ch]' | sort | xargs awk -f tests/rooms/tags.awk
}

# A function that only its own definition names.
unused() {
    symbols src | awk '$3 == "T" {print $2}' | sort >"$tmp/functions"
    find src codemodels tests -name '*.c' | xargs grep -owhE 'ns_[a-z0-9_]+' | sort | uniq -c | awk '$1 == 1 {print $2}' |
        comm -12 - "$tmp/functions"
}

check() {
    rule 'rooms use only rooms below them, engines never each other' read_symbols arrows src
    rule 'no circle of files inside a room' read_symbols circles src
    rule 'no circle of files in codemodels/bridge' read_symbols circles codemodels/bridge
    rule "external functions begin with their room's name" read_symbols names src
    rule 'no file includes a header of a room above it' read_includes
    rule 'nothing in src/ includes a header of ngspice' ngspice_in_src
    rule 'a tag or a type has one meaning' two_meanings
    rule 'every external function is called' unused
}

# figures_of TREE: "WHAT: NUMBER" lines.  The paths of tests come from $tmp/renamed: OLD NEW, where a file moved.
figures_of() {
    (
        cd "$1" || exit 1
        for part in src codemodels; do
            printf 'lines of %s: %d\n' "$part" \
                "$(find $part -name '*.[ch]' -o -name '*.mod' -o -name '*.ifs' | xargs cat | wc -l)"
        done
        find src codemodels -name '*.[ch]' | xargs awk -f "$OLDPWD/tests/rooms/functions.awk" | awk '{
            print "functions: " $1; print "functions, median of lines: " $2; print "functions, 90 % of lines: " $3
            print "functions, longest: " $4}'
        find src codemodels -name '*.c' -o -name '*.h' | xargs wc -l | awk '$2 != "total" {if ($1 > 400) n++}
            END {print "files above 400 lines: " n + 0}'
        for dir in src/*/; do
            [ ! -d "$dir" ] || printf 'lines of %s: %d\n' "${dir%/}" "$(find "$dir" -name '*.[ch]' | xargs cat | wc -l)"
        done
        find tests -name '*.[ch]' | sort | xargs awk -v renamed="$tmp/renamed" '
            BEGIN {while ((getline line < renamed) > 0) {split(line, part); now[part[1]] = part[2]}}
            FNR == 1 {
                path = FILENAME in now ? now[FILENAME] : FILENAME
                count = split(path, part, "/")
                at = count > 3 ? part[1] "/" part[2] "/" part[3] : part[1] "/" part[2]
            }
            {n = gsub(/assert_[a-z_]+\(/, "&"); a[at] += n; all += n; n = gsub(/cmocka_unit_test/, "&"); t[at] += n; tests += n}
            END {
                for (at in a) if (a[at] || t[at]) {
                    print "assertions in " at ": " a[at]
                    print "tests in " at ": " t[at]
                }
                print "assertions: " all; print "tests: " tests
            }' | sort
        printf 'netlists of tests and examples: %d\n' \
            "$(find netlists tests/netlist \( -name '*.cir' -o -name '*.sh' \) | wc -l)"
        printf 'measurements in netlists of tests: %d\n' "$(grep -rhciE '^ *\.?meas' tests/netlist netlists | awk '
            {n += $1} END {print n + 0}')"
    )
}

# followed COMMIT: the present names of the sources that it has, through every rename since (30 % alike).
followed() {
    {
        git ls-tree -r --name-only "$1" src codemodels | sed -n 's/.*\.\([ch]\|mod\|ifs\)$/is	&/p'
        git log --reverse --no-color --format= --name-status -M30% -l9999 --diff-filter=RD "$1..HEAD" -- src codemodels
        git diff --no-color --name-status -M30% --diff-filter=RD HEAD -- src codemodels
    } | awk -F'\t' '
        $1 == "is" {there[$2]; next}
        $1 ~ /^R/ && $2 in there {there[$3]}
        {delete there[$2]}
        END {for (name in there) print name}'
}

figures() {
    : >"$tmp/renamed"
    figures_of . >"$tmp/after"
    : >"$tmp/before"
    two=
    if git cat-file -e "${1:-none}^{commit}" 2>/dev/null; then
        two=1
        mkdir -p "$tmp/tree"
        git archive "$1" src codemodels include tests netlists | tar -x -C "$tmp/tree" || exit 1
        git diff -M30% --name-status --diff-filter=R "$1" -- tests | awk '{print $2, $3}' >"$tmp/renamed"
        figures_of "$tmp/tree" >"$tmp/before"
        name='lines of the sources there were before, by their renames'
        awk -F': ' -v name="$name" '/^lines of (src|codemodels):/ {n += $2} END {print name ": " n}' "$tmp/before" >"$tmp/sum"
        cat "$tmp/sum" >>"$tmp/before"
        followed "$1" | xargs cat | awk -v name="$name" 'END {print name ": " NR}' >>"$tmp/after"
        printf '%-58s %8s %8s\n' '' before now
    fi
    awk -F': ' -v two=$two 'FILENAME ~ /before$/ {before[$1] = $2; next}
        two {printf "%-58s %8s %8s\n", $1, $1 in before ? before[$1] : "-", $2; delete before[$1]; next}
        {printf "%-58s %8s\n", $1, $2}
        END {for (n in before) printf "%-58s %8s %8s\n", n, before[n], "-"}' "$tmp/before" "$tmp/after"
}

case ${1:-check} in
check) check ;;
graph) read_symbols graph src ;;
figures) shift && figures "$@" ;;
*) echo "tests/rooms.sh: no such part: $1" >&2 && exit 2 ;;
esac
exit $status
