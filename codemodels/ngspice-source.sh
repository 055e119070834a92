#!/bin/sh
# codemodels/ngspice-source.sh - the source tree of the ngspice that is installed: headers, cmpp, dlmain.c.
#
#     codemodels/ngspice-source.sh DIR
#
# Leaves in DIR/tree a configured tree with cmpp built, and DIR/stamp when all of it is there.  It is that of the
# source package (source-package.sh).
# NGSPICE names the binary (default: ngspice).  One that lies where it was built, in src of its tree, is taken with
# that tree; NGSPICE_SRC=tree says which one otherwise.  A copy is taken; a tree that is configured is used as it
# is, one that was configured in a folder of its own (there is a Makefile, but no source) with its source.
set -eu

dir=$1
ngspice=${NGSPICE:-ngspice}
src=${NGSPICE_SRC:-}

say() {
    printf 'ngspice source: %s\n' "$*"
}

die() {
    printf 'ngspice source: %s\n' "$*" >&2
    exit 1
}

# Runs a command quietly; shows the end of what it said if it fails.
quietly() {
    log=$dir/$1.log
    shift
    "$@" >"$log" 2>&1 </dev/null || {
        tail -n 20 "$log" >&2
        die "failed: $* (all of it in $log)"
    }
}

# The version that the binary names, "39" for example.
binary_version() {
    [ ! -d "$ngspice" ] || die "NGSPICE=$ngspice is a folder: give the program in it, $ngspice/src/ngspice for example"
    command -v "$ngspice" >/dev/null 2>&1 || die "there is no program $ngspice: NGSPICE=FILE names one"
    said=$("$ngspice" --version 2>/dev/null </dev/null | sed -n 's/^\*\* ngspice-\([^ ]*\).*/\1/p')
    [ -n "$said" ] || die "$(command -v "$ngspice") is no ngspice: its --version names none"
    echo "$said"
}

# The version of the headers of the tree $1, "" if it is not configured.
headers_version() {
    sed -n 's/^#define PACKAGE_VERSION "\(.*\)"/\1/p' "$1/src/include/ngspice/config.h" 2>/dev/null || true
}

check_version() {
    headers=$(headers_version "$1")
    [ "$headers" = "$binary" ] ||
        die "the source is ngspice $headers but $(command -v "$ngspice") is ngspice $binary: they must be the same"
}

# The Debian version of the source that the installed binary was made from.
installed_version() {
    package=$(dpkg-query -S "$(command -v "$ngspice")" 2>/dev/null | cut -d: -f1) || true
    [ -n "$package" ] ||
        die "$(command -v "$ngspice") is of no package, and not where it was built: give the tree it was made from as NGSPICE_SRC=dir"
    dpkg-query -W -f '${source:Package} ${source:Version}' "$package"
}

# Fetches source $1, version $2, and unpacks it into $dir/tree.
fetch() {
    said=$("$(dirname "$0")/source-package.sh" "$dir" "$1" "$2") || die "get the source of $1 $2 yourself, and give its folder: make deps NGSPICE_SRC=DIR (and so for make, make demo, make test)"
    say "$said"
}

# The tree that the binary was built in, "" if it is not in one.
tree_around() {
    tree=$(cd "$(dirname "$(command -v "$ngspice")")/.." 2>/dev/null && pwd -P) || return 0
    [ ! -f "$tree/src/include/ngspice/config.h" ] || [ ! -f "$tree/config.status" ] || echo "$tree"
}

# Copies the files of $1 that are no results of a compiler to $dir/tree.
copy_from() {
    (cd "$1" && tar -cf - --exclude=.git --exclude='*.o' --exclude='*.a' --exclude='*.lo' --exclude='.libs' ${2:+"--exclude=$2"} .) |
        (cd "$dir/tree" && tar -xf -)
}

# Is the user's tree one, and of the version of the binary?  Sets code, where its source is.
check_tree() {
    [ -d "$src" ] || die "NGSPICE_SRC=$src is no folder"
    code=$src
    [ -f "$src/src/xspice/icm/dlmain.c" ] ||
        code=$(cd "$src" && cd "$(sed -n 's/^top_srcdir = //p' Makefile 2>/dev/null | head -n 1)" 2>/dev/null && pwd -P) || code=$src
    [ -f "$code/src/xspice/icm/dlmain.c" ] || die "NGSPICE_SRC=$src holds no src/xspice/icm/dlmain.c"
    config=$src/src/include/ngspice/config.h
    if [ ! -f "$config" ]; then
        [ "$code" = "$src" ] || die "NGSPICE_SRC=$src is not configured"
        return
    fi
    check_version "$src"
    grep -q '^#define XSPICE' "$config" || die "$src was configured without --enable-xspice: that ngspice takes no code models"
}

# Copies the user's tree to $dir/tree.
copy() {
    say "copying $src"
    mkdir -p "$dir/tree"
    if [ "$code" != "$src" ]; then
        copy_from "$code" "./$(basename "$src")"
    fi
    copy_from "$src"
}

# The package's own configure flags, less those of its user interface, which no header of ours depends on.
flags() {
    if [ -f debian/rules ]; then
        # shellcheck disable=SC2016 # make expands it
        make -s -f debian/rules --eval 'ns-flags: ; @echo $(DEB_NGSPICE_CONFIGURE_OPTS)' ns-flags |
            tr ' ' '\n' | grep -v -e '^--with-x$' -e '^--with-editline' | grep '^--' || true
    fi
}

configure() {
    cd "$dir/tree"
    dir=.. # quietly's logs
    if [ ! -f src/include/ngspice/config.h ]; then
        options=$(flags)
        case $options in *--enable-xspice*) ;; *)
            say "no flags in debian/rules; taking those that Debian's ngspice 39 was made with"
            options='--enable-cider --enable-openmp --enable-pss --enable-xspice --disable-debug'
            ;;
        esac
        say "configuring (half a minute)"
        [ -x configure ] || quietly autogen ./autogen.sh
        # shellcheck disable=SC2086 # words
        quietly configure ./configure --quiet $options --without-x --with-readline=no
    fi
    [ -x src/xspice/cmpp/cmpp ] || quietly cmpp make -C src/xspice/cmpp
}

binary=$(binary_version)
[ -n "$src" ] || src=$(tree_around)
if [ -n "$src" ]; then
    check_tree
    # Its configuration may change while its name stays.
    wanted="$src $(cksum 2>/dev/null <"$config" || true)"
else
    wanted=$(installed_version)
fi
[ "$(cat "$dir/stamp" 2>/dev/null)" = "$wanted" ] && exit 0

rm -rf "$dir"
mkdir -p "$dir"
if [ -n "$src" ]; then
    copy
else
    # shellcheck disable=SC2086 # name and version
    fetch $wanted
fi
(configure)
check_version "$dir/tree"
echo "$wanted" >"$dir/stamp"
say "ready in $dir/tree"
