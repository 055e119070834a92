# tests/corpus/means.awk - of the header of a raw file and, a line for each point, its numbers: `NODE MEAN SIZE` for each
# node voltage; SIZE is the mean of its magnitude.

function finish(    k) {
    for (k = 1; k < count; k++)
        if (span > 0 && is_node[k])
            print name[k], sum[k] / span, size[k] / span
}

/^No. Variables:/ { count = $3 }
/^Variables:/ { in_names = 1; next }
/^Binary:/ { in_names = 0; in_values = 1; next }
in_names { name[$1] = tolower($2); is_node[$1] = $3 == "voltage" && $2 !~ /#/; next }
in_values && NF == count {
    step = points++ ? $1 - before[0] : 0
    for (k = 1; k < count; k++) {
        now = $(k + 1)
        sum[k] += 0.5 * step * (now + before[k])
        size[k] += 0.5 * step * ((now < 0 ? -now : now) + (before[k] < 0 ? -before[k] : before[k]))
        before[k] = now
    }
    before[0] = $1
    span += step
}
END { finish() }
