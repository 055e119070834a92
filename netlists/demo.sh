#!/bin/sh
# netlists/demo.sh - runs the buck converter in the stock ngspice with our code models and draws its waveforms.
#
#     netlists/demo.sh PICTURE         (.png or .svg)
#
# NGSPICE names the binary (default: ngspice).
set -eu
cd "$(dirname "$0")/.."
picture=$1
circuit=netlists/buck_ccm.cir
ngspice=${NGSPICE:-ngspice}

# The netlist as it is, and one line more: write the waveforms to a file.  ngspice reads .spiceinit from the
# folder it runs in; that line is all that a user of nonsmooth needs too.
run=build/demo
mkdir -p $run
echo "codemodel '$PWD/build/nonsmooth.cm'" >$run/.spiceinit
sed 's/^run$/run\nset wr_singlescale\nwrdata waveforms.data v(x) i(l1) v(out)/' $circuit >$run/buck.cir
rm -f $run/waveforms.data

echo "Circuit   $circuit: 12 V to 4.8 V at 100 kHz, one ideal switch, one ideal diode, from rest"
echo "Running   $(command -v "$ngspice") -b buck.cir   in $run, where .spiceinit says: codemodel .../nonsmooth.cm"
status=0
(cd $run && "$ngspice" -b buck.cir >ngspice.log 2>&1 </dev/null) || status=$?
grep -E '^(nonsmooth|[a-z0-9 ,=.]*:? +expected)' $run/ngspice.log | sed 's/^/          /' || true
if [ $status != 0 ] || [ ! -s $run/waveforms.data ]; then
    tail -n 20 $run/ngspice.log >&2
    echo "The demo failed: ngspice ended with status $status; all it said is in $run/ngspice.log" >&2
    exit 1
fi

case $picture in
*.svg) terminal="svg size 1000,620 font 'sans,13' background '#ffffff'" step=3e-7 ;;
*) terminal="pngcairo size 1500,930 font 'sans,15' linewidth 1.6" step=0 ;;
esac
# For a small drawing: a point every `step`, and both sides of every jump of the switch node.
awk -v step=$step '
    {jump = NR > 1 && ($2 - before)^2 > 1; before = $2}
    jump && line {print line}
    {line = $0}
    NR == 1 || jump || $1 - t >= step {print; t = $1; line = ""}
    END {if (line) print line}' $run/waveforms.data >$run/drawn.data
gnuplot -e "set terminal $terminal; set output '$picture'; data = '$run/drawn.data'" netlists/demo.gp
echo "Picture   $PWD/$picture"
