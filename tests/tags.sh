#!/bin/sh
# tests/tags.sh - every equation tag, like (T1), that code cites is defined in the Method of src/README.md, and the reverse.
#
# A tag is defined where it stands first on a line of the section "## Method".
cd "$(dirname "$0")/.." || exit 1

tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
find src include codemodels -name '*.[ch]' -exec grep -ohE '\([A-Z][0-9]+\)' {} + | sort -u >"$tmp/cited"
sed -n '/^## Method/,/^## [^M]/p' src/README.md | grep -oE '^[[:space:]*`-]*\([A-Z][0-9]+\)' | tr -d ' *`\t-' |
    sort -u >"$tmp/defined"

status=0
# shellcheck disable=SC2013 # words
for tag in $(cat "$tmp/cited" "$tmp/defined" | sort -u); do
    if ! grep -qxF "$tag" "$tmp/defined"; then
        echo "FAIL $tag is cited but not defined in the Method of src/README.md:"
        grep -rnF "$tag" src include codemodels --include='*.[ch]' | head -n 3
        status=1
    elif ! grep -qxF "$tag" "$tmp/cited"; then
        echo "FAIL $tag is defined in the Method of src/README.md but cited nowhere in src, include, codemodels"
        status=1
    else
        echo "ok $tag"
    fi
done
exit $status
