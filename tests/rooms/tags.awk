# tests/rooms/tags.awk - tags of structs, unions and enums, and names of types, that mean two things: stand in two files.
#
#     awk -f tags.awk FILE...
function is(kind, name,    at) {
    at = kind " " name
    if (!(at in where)) where[at] = FILENAME
    else if (where[at] != FILENAME) print at ": " where[at] " and " FILENAME ":" FNR
}
/(struct|union|enum) [a-z0-9_]+ \{/ {
    tag = $0
    sub(/ \{.*/, "", tag)
    sub(/.*(struct|union|enum) /, "", tag)
    is("tag", tag)
}
# typedef struct NAME NAME; says no more than the tag does.
/^typedef .*;$/ {
    sub(/ __attribute__.*/, ";")
    name = $NF
    sub(/;/, "", name)
    if ($0 ~ /\(\*/) {name = $0; sub(/.*\(\*/, "", name); sub(/\).*/, "", name)}
    if ($3 != name) is("type", name)
    next
}
/^typedef / {tag = $3; open = 1}
/^\} [a-z0-9_]+;$/ && open {
    name = $2
    sub(/;/, "", name)
    if (name != tag) is("type", name)
    open = 0
}
