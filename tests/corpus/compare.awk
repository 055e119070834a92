# tests/corpus/compare.awk - two lists of means.awk: the largest difference of means, in percent of the reference's size, and where.
#
#     awk -f compare.awk REFERENCE LIST
#
# The size of a node is the mean magnitude of its voltage there, or a thousandth of the largest of the circuit, if that is more.

FNR == NR { mean[$1] = $2; size[$1] = $3; if ($3 > most) most = $3; next }
$1 in mean {
    shared++
    scale = size[$1] > 1e-3 * most ? size[$1] : 1e-3 * most
    difference = $2 - mean[$1]
    error = scale > 0 ? 100 * (difference < 0 ? -difference : difference) / scale : 0
    if (!(error <= worst)) { worst = error; where = $1 }
}
END { if (shared) printf "%.2f %s\n", worst, where == "" ? "-" : where; else print "nothing -" }
