# tests/rooms/symbols.awk - who uses whom, from the symbols of objects.
#
#     awk -v what=WHAT -v root=FOLDER/ -f layers.awk -f symbols.awk layers PUBLIC... INCLUDES SYMBOLS
#
# PUBLIC: the public headers.  INCLUDES: lines "src/ROOM/FILE:#include "ROOM/..., for the graph.  SYMBOLS: of nm -g -P
# -A, the objects below root.
# what: graph (each room and the rooms it uses), arrows (those that may not be), circles (of files in a room), names
# (external functions without their room's name); all but graph print only what is wrong.
FILENAME ~ /\.h$/ {
    line = $0
    while (match(line, /ns_[a-z0-9_]+\(/)) {
        public[substr(line, RSTART, RLENGTH - 1)] = 1
        line = substr(line, RSTART + RLENGTH)
    }
    next
}
FILENAME ~ /includes$/ {
    split($0, part, "\"")
    sub(/^src\//, "", part[1])
    between[room(part[1]), room(part[2])] = 1
    next
}
{
    file = substr($1, length(root) + 1)
    sub(/\.o:$/, "", file)
    files[file] = 1
    if ($3 == "U") uses[file, $2] = 1
    else if ($3 ~ /[A-Z]/) from[$2] = file
}

function room(f) {
    sub(/\/.*/, "", f)
    return f
}

function graph(    i, j, line) {
    for (i = 1; i <= rooms; i++) {
        line = sprintf("%-8s ->", order[i])
        for (j = 1; j <= rooms; j++)
            if ((order[i], order[j]) in between && i != j) line = line " " order[j]
        print line
    }
}

function arrows(    a, part, f) {
    for (a in arrow) {
        split(a, part, SUBSEP)
        if (!may(room(part[1]), room(part[2]))) print part[1] ".c uses " part[2] ".c:" arrow[a]
    }
}

# Circles: files that reach each other.  reach: by calls inside a room, closed transitively.
function circles(    a, b, c, part, line, seen) {
    for (a in arrow) {
        split(a, part, SUBSEP)
        if (room(part[1]) == room(part[2]) || root ~ /bridge/) reach[part[1], part[2]] = 1
    }
    for (b in files) for (a in files) if ((a, b) in reach)
        for (c in files) if ((b, c) in reach) reach[a, c] = 1
    for (a in files) if ((a, a) in reach && !(a in seen)) {
        line = ""
        for (b in files) if ((a, b) in reach && (b, a) in reach) {
            seen[b] = 1
            for (c in files) if ((b, c) in arrow && b != c && (c, a) in reach && (a, c) in reach)
                line = line "\n    " b " -> " c ":" arrow[b, c]
        }
        print "circle:" line
    }
}

function names(    s, r) {
    for (s in from) {
        r = root ~ /bridge/ ? "bridge" : room(from[s])
        if (s != "main" && !(s in public) && index(s, "ns_" r "_") != 1) print from[s] ".c: " s
    }
}

END {
    for (u in uses) {
        split(u, part, SUBSEP)
        if (!(part[2] in from) || from[part[2]] == part[1]) continue
        arrow[part[1], from[part[2]]] = arrow[part[1], from[part[2]]] " " part[2]
        between[room(part[1]), room(from[part[2]])] = 1
    }
    if (what == "graph") graph()
    if (what == "arrows") arrows()
    if (what == "circles") circles()
    if (what == "names") names()
}
