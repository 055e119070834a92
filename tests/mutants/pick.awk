# tests/mutants/pick.awk - MOST of the candidates, each place at most once, in an order that the seed makes.
#
#     awk -v seed=SEED -v most=MOST -f pick.awk CANDIDATES
BEGIN {FS = "\t"; state = seed % 2147483646 + 1; for (k = 0; k < 20; k++) below(1)}

# A random number 0 ... n-1: Park and Miller's generator.
function below(n) {
    state = state * 16807 % 2147483647
    return int(state / 2147483647 * n)
}
{
    if ($1 != last) first[places++] = NR
    last = $1
    line[NR] = $0
}
END {
    first[places] = NR + 1
    for (k = 0; k < places; k++) order[k] = k
    for (k = 0; k < most && k < places; k++) {
        j = k + below(places - k)
        p = order[j]; order[j] = order[k]
        print line[first[p] + below(first[p + 1] - first[p])]
    }
}
