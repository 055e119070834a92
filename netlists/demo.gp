# netlists/demo.gp - the waveforms of the buck converter; called by demo.sh, which sets the output and `data`.
#
# Columns of data: time (s), switch node (V), inductor current (A), output (V).
# Left: from rest.  Right: two periods of the steady state; the netlist runs to 1.22 ms.

set multiplot layout 3,2 columnsfirst margins 0.075,0.975,0.085,0.90 spacing 0.085,0.035 \
    title "Buck converter with an ideal switch and an ideal diode, in ngspice" offset 0,-0.2
set grid linetype 1 linewidth 0.5 linecolor rgb '#e4e4e4'
set tics nomirror scale 0.6
set border 3 linecolor rgb '#606060'
set key off
set style line 1 linecolor rgb '#1f4e9c' linewidth 1.3
set style line 2 linecolor rgb '#c0392b' linewidth 1.3
set style line 3 linecolor rgb '#1e7d4b' linewidth 1.3

do for [side = 0:1] {
    from = side ? 1200 : 0
    to = side ? 1220 : 300
    set xrange [from:to]
    set xtics from, side ? 5 : 50
    unset xlabel
    set format x ''

    set title side ? 'steady state' : 'from rest' offset 0,-0.7
    set yrange [-1:14]
    set ytics 0, 4
    set ylabel side ? '' : 'switch node (V)'
    plot data using ($1*1e6):2 with lines linestyle 1
    unset title

    if (side) { set yrange [0.75:1.2]; set ytics 0.8, 0.1 } else { set yrange [-0.1:2]; set ytics 0, 0.5 }
    set ylabel side ? '' : 'inductor current (A)'
    plot data using ($1*1e6):3 with lines linestyle 2

    set format x '%g'
    set xlabel 'time (µs)' offset 0,0.4
    if (side) { set yrange [4.77:4.83]; set ytics 4.78, 0.02 } else { set yrange [0:8]; set ytics 0, 2 }
    set ylabel side ? '' : 'output voltage (V)'
    plot data using ($1*1e6):4 with lines linestyle 3
}
unset multiplot
