#!/bin/sh
# codemodels/install-packages.sh - installs those of the named Debian packages that are missing.
#
#     codemodels/install-packages.sh PACKAGE...
#
# As root, or through sudo.  Says what it installs before it does; silent and offline when all is there.
set -eu

command -v dpkg-query >/dev/null 2>&1 || {
    echo "This is no Debian system: install the equivalents of these yourself: $*" >&2
    exit 0
}

missing=
for package; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) || state=none
    [ "$state" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

refuse() {
    echo "$1  As root: apt-get update && apt-get install --no-install-recommends$missing" >&2
    exit 1
}

if [ "$(id -u)" = 0 ]; then
    root=
elif command -v sudo >/dev/null 2>&1; then
    root=sudo
else
    refuse "Missing Debian packages, and neither root nor sudo to install them."
fi

apt() {
    $root env DEBIAN_FRONTEND=noninteractive apt-get -q "$@" </dev/null
}

install() {
    # shellcheck disable=SC2086 # words
    apt install -y --no-install-recommends $missing
}

# Would the system's package lists do?  Asking needs no root.
known() {
    # shellcheck disable=SC2086 # words
    apt-get --simulate --no-install-recommends install $missing >/dev/null 2>&1 </dev/null
}

echo "Installing from Debian:$missing"
[ -z "$root" ] || $root true || refuse "No right to install them."
{ known && install; } || {
    apt update || true # one broken source must not stop the others
    install
} || refuse "Could not install them."
