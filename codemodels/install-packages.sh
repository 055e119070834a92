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

if [ "$(id -u)" = 0 ]; then
    root=
elif command -v sudo >/dev/null 2>&1; then
    root=sudo
else
    echo "Missing Debian packages, and neither root nor sudo to install them.  As root: apt-get install$missing" >&2
    exit 1
fi

apt() {
    $root env DEBIAN_FRONTEND=noninteractive apt-get -q "$@" </dev/null
}

install() {
    # shellcheck disable=SC2086 # words
    apt install -y --no-install-recommends "$@" $missing
}

echo "Installing from Debian:$missing"
# The system's package lists are renewed only where the present ones will not do.
install --simulate >/dev/null 2>&1 || apt update
install || {
    apt update
    install
}
