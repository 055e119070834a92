# tests/rooms/includes.awk - headers that a file may not include, by the layers of rooms.
#
#     awk -f layers.awk -f includes.awk layers FILE...
#
# src/ROOM/...: headers of rooms it may use; nothing of ngspice.  codemodels/: public headers alone, of the library.
FNR == 1 {own = FILENAME; sub(/^.*src\//, "", own); sub(/\/.*/, "", own)}
/^#include/ {
    name = $2
    gsub(/[<>"]/, "", name)
    if (name !~ /\// || $2 ~ /^<.*suitesparse/) next # beside the file, or the system's
    of = name
    sub(/\/.*/, "", of)
    if (of == "nonsmooth") {
        sub(/.*\//, "", name)
        of = name in header ? header[name] : "no room: " name
    }
    if (FILENAME ~ /codemodels\//) {
        if (of in level && $2 !~ /nonsmooth\//) print FILENAME ":" FNR ": " $0
    } else if (!may(own, of))
        print FILENAME ":" FNR ": " $0
}
