# tests/corpus/means.awk - of an ASCII raw file: `NODE MEAN SIZE` for each node voltage; SIZE is the mean of its magnitude.

function finish(    k) {
    for (k = 1; k < count; k++)
        if (span > 0 && is_node[k])
            print name[k], sum[k] / span, size[k] / span
}

/^No. Variables:/ { count = $3 }
/^Variables:/ { in_names = 1; next }
/^Values:/ { in_names = 0; in_values = 1; column = -1; next }
in_names { name[$1] = tolower($2); is_node[$1] = $3 == "voltage" && $2 !~ /#/; next }
in_values && NF {
    if (column < 0) { now[0] = $2; column = 1 } else now[column++] = $1
    if (column < count) next
    step = points++ ? now[0] - before[0] : 0
    for (k = 1; k < count; k++) {
        sum[k] += 0.5 * step * (now[k] + before[k])
        size[k] += 0.5 * step * ((now[k] < 0 ? -now[k] : now[k]) + (before[k] < 0 ? -before[k] : before[k]))
        before[k] = now[k]
    }
    before[0] = now[0]
    span += step
    column = -1
}
END { finish() }
