# tests/rooms/functions.awk - how long the functions of formatted C files are: number, median, 90 %, longest.
#
# From the line at column 0 in which a function's name is to the } at column 0.
FNR == 1 {on = 0}
/^[a-z].*\(/ && !/;$/ && !/^(typedef|struct|enum|union|extern) *\{/ && !/ = / {on = FNR; body = 0}
on && /\{$/ {body = 1}
on && !body && /;$/ {on = 0}
/^\}/ {
    if (on && body) count[FNR - on + 1]++
    on = 0
}
END {
    for (l in count) {all += count[l]; if (l + 0 > top) top = l + 0}
    for (l = 1; l <= top; l++) {
        seen += count[l]
        if (!half && 2 * seen >= all) half = l
        if (!most && 10 * seen >= 9 * all) most = l
    }
    print all + 0, half + 0, most + 0, top + 0
}
