# tests/readmes/names.awk - what a README names: lines "KIND NAME".
#
# file: a path, or a file's name; folder; function; name (ns_..., NS_...); target, variable (of make); parameter
# MODEL.NAME; flag (--NAME, of our own programs).  All but functions and names only from `code`, code blocks and links.
BEGIN {extensions = "\\.(c|h|cpp|sh|awk|cir|lib|svg|png|md|mod|ifs|map|txt)$"}

function say(kind, name) {
    if (name != "") print kind, name
}

# Of ngspice's lines: .model NAME TYPE(parameter=value ...)
function model(text,    part, k, n, type) {
    if (text !~ /^\.model [a-z0-9]+ (ideal_diode|ideal_switch|nonsmooth) *\(/) return 0
    n = split(text, part, /[ (]+/)
    type = part[3]
    for (k = 4; k <= n; k++) if (part[k] ~ /=/) {
        sub(/=.*/, "", part[k])
        say("parameter", type "." part[k])
    }
    return 1
}

function make(text,    part, n, k) {
    n = split(text, part, / +/)
    for (k = 2; k <= n && part[k] !~ /^#/; k++) {
        if (part[k] ~ /^[A-Z_]+=/) {sub(/=.*/, "", part[k]); say("variable", part[k])}
        else if (part[k] ~ /^[a-z][a-z-]*$/) say("target", part[k])
    }
}

# A piece of code: a span between backquotes, or a line of a block.
function code(text,    part, n, k, word) {
    sub(/^(sudo|\$) /, "", text)
    if (model(text)) return
    if (text ~ /^make( |$)/) {make(text); return}
    n = split(text, part, /[ ,;()'"|]+/)
    for (k = 1; k <= n; k++) {
        word = part[k]
        sub(/[.:]+$/, "", word)
        sub(/:[0-9]+(-[0-9]+)?$/, "", word)
        if (word ~ /^--[a-z]/ && text !~ /pkg-config/) say("flag", word)
        if (word !~ /^[A-Za-z0-9_.][A-Za-z0-9_.\/-]*$/ || word ~ /\.\.\.|^\/|^(build|PREFIX|share)\//) continue
        if (word ~ /^[a-z].*\/$/) say("folder", substr(word, 1, length(word) - 1))
        else if (word ~ extensions && word !~ /^\./) say("file", word)
    }
}

FNR == 1 {block = 0; columns = ""}
/^```/ {block = !block; next}
{
    line = $0
    while (match(line, /[A-Za-z0-9_]+\(\)/)) {
        say("function", substr(line, RSTART, RLENGTH - 2))
        line = substr(line, RSTART + RLENGTH)
    }
    line = $0
    while (match(line, /(^|[^A-Za-z0-9_])(ns|NS)_[A-Za-z0-9_]*[A-Za-z0-9]/)) {
        name = substr(line, RSTART, RLENGTH)
        sub(/^[^nN]/, "", name)
        line = substr(line, RSTART + RLENGTH)
        if (line !~ /^(_?\.\.\.|_?\*)/) say("name", name)
    }
}
block || (/^    / && !/^ *[-*] /) {line = $0; sub(/^ +/, "", line); code(line); next}
# Tables of options and of models.
/^\| *option / {columns = "options"; next}
/^\| *line *\| *model / {columns = "models"; next}
!/^\|/ {columns = ""}
columns == "options" && /^\| *`/ {
    split($0, cell, "|")
    n = split(cell[2], span, "`")
    for (k = 2; k <= n; k += 2) say("parameter", "nonsmooth." span[k])
}
columns == "models" && /^\| *`/ {
    split($0, cell, "|")
    split(cell[3], span, "`")
    type = span[2]
    n = split(cell[4], span, "`")
    for (k = 2; k < n; k += 2) if (span[k + 1] ~ /^ \(/) say("parameter", type "." span[k])
}
{
    n = split($0, span, "`")
    for (k = 2; k <= n; k += 2) code(span[k])
    line = $0
    while (match(line, /\]\([^)]*\)/)) {
        target = substr(line, RSTART + 2, RLENGTH - 3)
        line = substr(line, RSTART + RLENGTH)
        sub(/#.*/, "", target)
        if (target !~ /^[a-z]+:/ && target ~ /[.\/]/) say("link", target)
    }
}
