# tests/rooms/layers.awk - reads tests/rooms/layers; may(A, B): room A may use room B.
FILENAME ~ /layers$/ {
    if (/^#/) next
    if ($1 == "headers") {
        for (k = 2; k <= NF; k++) {split($k, pair, "="); header[pair[1] ".h"] = pair[2]}
        next
    }
    layer++
    if ($1 ~ /:$/) {
        only[substr($1, 1, length($1) - 1)] = " " $0 " "
        sub(/:.*/, "")
    }
    for (k = 1; k <= NF; k++) {level[$k] = layer; order[++rooms] = $k}
    next
}

function may(a, b) {
    if (a == b) return 1
    if (!(a in level) || !(b in level)) return 0
    return a in only ? index(only[a], " " b " ") > 0 : level[b] < level[a]
}
