#!/bin/sh
# codemodels/source-package.sh - a source package of the system, unpacked into DIR/tree.
#
#     codemodels/source-package.sh DIR NAME [VERSION]
#
# It is fetched by an apt of its own (its state in DIR/apt, its sources made from the system's), so the system's
# package lists stay as they are and nobody needs to be root.  One line and exit status 1 if there is none.
set -eu

dir=$1 name=$2 version=${3:-}

die() {
    printf 'source package: %s\n' "$*" >&2
    exit 1
}

# /etc/apt's sources with deb-src in place of deb, in both formats.
write_sources() {
    parts=$1
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
        [ -f "$file" ] || continue
        sed -n 's/^[[:space:]]*deb\(-src\)\{0,1\}[[:space:]]\{1,\}/deb-src /p' "$file" |
            grep -v 'cdrom:' | sort -u >"$parts/$(basename "$file")" || true
    done
    for file in /etc/apt/sources.list.d/*.sources; do
        [ -f "$file" ] || continue
        sed 's/^[Tt]ypes:.*/Types: deb-src/' "$file" >"$parts/$(basename "$file")"
    done
}

mkdir -p "$dir"
apt=$(cd "$dir" && pwd)/apt
rm -rf "$apt"
mkdir -p "$apt/parts" "$apt/lists/partial" "$apt/cache/archives/partial" "$apt/get"
write_sources "$apt/parts"
set -- -q -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$apt/parts" \
    -o "Dir::State::lists=$apt/lists" -o "Dir::Cache=$apt/cache" -o "APT::Sandbox::User=$(id -un)" \
    -o APT::Update::Post-Invoke-Success::= -o APT::Update::Post-Invoke::=
echo "fetching the source package $name${version:+ $version}"
# One source without a deb-src half must not stop the others: what counts is whether the version is found.
apt-get "$@" update >"$dir/update.log" 2>&1 </dev/null || true
(cd "$apt/get" && apt-get "$@" source --download-only "$name${version:+=$version}" >"$apt/get.log" 2>&1 </dev/null) || {
    # apt-get says the cause first, or that its lists lack the package, which an error of update explains.
    why=$(sed -n 's/^E: //p' "$apt/get.log" "$dir/update.log" | head -n 1)
    die "apt has no source of $name${version:+ $version}: $why (all of it in $apt/get.log, $dir/update.log)"
}
dpkg-source --no-check -x "$apt"/get/*.dsc "$dir/tree" >"$dir/unpack.log" 2>&1 </dev/null || {
    tail -n 20 "$dir/unpack.log" >&2
    die "the source of $name cannot be unpacked (all of it in $dir/unpack.log)"
}
[ -z "$version" ] || [ "$(dpkg-parsechangelog -l "$dir/tree/debian/changelog" -S Version)" = "$version" ] ||
    die "what was fetched is not version $version"
rm -rf "$apt" "$dir"/*.orig*.tar.*
