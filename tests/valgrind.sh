#!/bin/sh
# tests/valgrind.sh - one netlist through ngspice under valgrind.
#
#     tests/valgrind.sh [netlist]
#
# Counts only errors and definite leaks whose stack goes through our code model; ngspice has its own.
# NGSPICE names the program (default: ngspice).
cd "$(dirname "$0")/.." || exit 1
netlist=$PWD/${1:-netlists/halfwave_rc.cir}
out=$PWD/build/valgrind
rm -rf "$out"
mkdir -p "$out"
name=$(basename "$netlist" .cir)
echo "codemodel '$PWD/build/nonsmooth.cm'" >"$out/.spiceinit"

cd "$out" || exit 1
timeout 200 valgrind --quiet --leak-check=full --show-leak-kinds=definite --num-callers=40 --xml=yes \
    --xml-file=report.xml "${NGSPICE:-ngspice}" -b "$netlist" >ngspice.log 2>&1 </dev/null
status=$?
if [ $status != 0 ]; then
    echo "FAIL $name: ngspice under valgrind ended with $status"
    tail -n 20 ngspice.log
    exit 1
fi
# One record an error; only those with a frame in our .cm.
awk 'BEGIN {RS = "</error>"} /<obj>[^<]*nonsmooth\.cm</ {print; print "---"}' report.xml >ours.xml
if [ -s ours.xml ]; then
    echo "FAIL $name: $(grep -c '^---$' ours.xml) errors that go through our code"
    grep -E '<kind>|<text>|<what>|<fn>|<line>|^---' ours.xml | sed 's/<[^>]*>//g' | head -n 40
    exit 1
fi
grep -q '<state>FINISHED</state>' report.xml || {
    echo "FAIL $name: valgrind did not finish"
    exit 1
}
echo "ok $name: no error and no definite leak through our code"
