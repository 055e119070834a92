#!/bin/sh
# tests/install.sh - `make install` puts everything where it belongs, and what it put there works.
# NGSPICE names the program that loads it (default: ngspice).
cd "$(dirname "$0")/.." || exit 1
dest=$PWD/build/installed
rm -rf "$dest"
status=0
export NGSPICE="${NGSPICE:-ngspice}"

# check NAME COMMAND...
check() {
    name=$1
    shift
    if "$@" >"$dest.log" 2>&1 </dev/null; then
        echo "ok $name"
    else
        echo "FAIL $name: $*"
        cat "$dest.log"
        status=1
    fi
}

major=$(sed -n 's|^#define PACKAGE_VERSION "\([0-9]*\).*|\1|p' build/ngspice-src/tree/src/include/ngspice/config.h)
check 'make install' make install PREFIX="$dest"
for file in bin/nsc-mlcp lib/libnonsmooth.a lib/libnonsmooth.so include/nonsmooth.h include/nonsmooth/status.h \
    lib/pkgconfig/nonsmooth.pc lib/ngspice/nonsmooth.cm lib/ngspice/nonsmooth.inc "lib/ngspice/nonsmooth-$major.cm" share/nonsmooth/nonsmooth.lib share/nonsmooth/spiceinit; do
    check "$file is there" test -s "$dest/$file"
done

# example LANGUAGE FILE: the first example in that language that FILE shows.
example() {
    awk -v start="\`\`\`$1" '$0 == "```" {on = 0} on; $0 == start && !seen++ {on = 1}' "$2"
}

example c include/README.md >"$dest/user.c"
export PKG_CONFIG_PATH="$dest/lib/pkgconfig" LD_LIBRARY_PATH="$dest/lib"
check "include/README's program compiles and links against it" sh -c \
    "cc '$dest/user.c' -o '$dest/user' \$(pkg-config --cflags --libs nonsmooth)"
grep -E '^    [0-9.]+ us: [0-9.]+ V$' include/README.md | sed 's/^    //' >"$dest/user.expected"
check 'the program prints what include/README says' sh -c \
    "'$dest/user' >'$dest/user.out' && test -s '$dest/user.expected' && cmp '$dest/user.out' '$dest/user.expected'"
check 'the shared library shows no internals' sh -c \
    "nm -D --defined-only '$dest/lib/libnonsmooth.so' | grep -q ns_mlcp_solve$ &&
     ! nm -D --defined-only '$dest/lib/libnonsmooth.so' | grep -q ns_lu_"
check 'the library neither prints, nor exits, nor looks at the environment' sh -c \
    "! nm -D --undefined-only '$dest/lib/libnonsmooth.so' |
     grep -E ' (_*(v?f?printf|f?puts|f?putc|putchar|fwrite)(_chk)?|perror|_?exit|abort|getenv|stdout|stderr)(@|$)'"
printf '1 1 -1 0 inf' >"$dest/one.txt"
check 'nsc-mlcp solves' sh -c "'$dest/bin/nsc-mlcp' '$dest/one.txt' | grep -qx 'lambda 1'"

cat >"$dest/user.cir" <<'C'
* a diode in series with 1 kohm across 10 V; fails if the model is unknown
V1 in 0 10
AD1 in out dmod
R1 out 0 1k
.model dmod ideal_diode(vf=1)
.control
op
let e = abs(v(out) - 9)
if e le 1e-6
  quit 0
end
quit 1
.endc
.end
C
cp "$dest/share/nonsmooth/spiceinit" "$dest/.spiceinit"
check 'ngspice loads the installed code models' sh -c "cd '$dest' && \"\$NGSPICE\" -b user.cir"
check 'without the models of its version ngspice says so in one line' sh -c \
    "cd '$dest' && mv lib/ngspice/nonsmooth-$major.cm lib/ngspice/nonsmooth-38.cm && \"\$NGSPICE\" -b user.cir 2>&1 |
     grep -c '^nonsmooth: no code models for this ngspice, version $major' | grep -qx 1"
mv "$dest/lib/ngspice/nonsmooth-38.cm" "$dest/lib/ngspice/nonsmooth-$major.cm"
example spice README.md >"$dest/buck.cir"
check "README's netlist measures what README says" sh -c \
    "cd '$dest' && \"\$NGSPICE\" -b buck.cir | awk '/^vout/ {v = \$3} /^ripple/ {r = \$3}
     END {exit !(v > 4.7995 && v < 4.8005 && r > 0.28855 && r < 0.28865)}'"
cat >"$dest/own.cir" <<'C'
* the same with ngspice's own diode, found as installed
.include nonsmooth.inc
V1 in 0 10
D1 in out dmod
R1 out 0 1k
.model dmod d(is=1e-12 n=1)
.control
op
* 1e-12 A, vt = 25.864917 mV (300.15 K): 0.655118 V at 0.1 A
let e = abs(v(out) - (10 - 0.655118))
if e le 2e-6
  quit 0
end
quit 1
.endc
.end
C
check 'ngspice finds the installed nonsmooth.inc' sh -c "cd '$dest' && \"\$NGSPICE\" -b own.cir"
check 'make uninstall' make uninstall PREFIX="$dest"
check 'nothing of it is left' sh -c "cd '$dest' && ! find . ! -type d | grep -E 'nonsmooth|nsc-mlcp'"
exit $status
