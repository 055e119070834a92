# tests/corpus/flatten.awk - a netlist in one file, for one run of .tran and nothing else.
#
#     awk -v folder=FOLDER [-v block=N] -f flatten.awk FILE
#
# .include and .lib are replaced by what they name, as far as that is in FOLDER, the file's own; commands of .control go, but
# for a `tran`; so do other analyses and what shows results.  block: FILE is Markdown, of which the N-th fenced block is meant.
# What ngspice 39 has no word for is translated: `.tran 10m` and `.tran 0 10m` get a tstep, the sign of micro becomes u.

function without_quotes(word) {
    gsub(/["']/, "", word)
    return word
}

function is_there(path,    line, found) {
    found = (getline line < path) >= 0
    close(path)
    return found
}

# .tran with a step of a thousandth where none is given.
function with_step(words,    n, w) {
    n = split(words, w, /[ \t]+/)
    if (n == 1 || w[2] !~ /^[0-9.{]/)
        return value(w[1]) / 1000 " " words
    if (w[1] + 0 == 0 && w[1] ~ /^[0.]/) {
        sub(/^[^ \t]+/, value(w[2]) / 1000, words)
        return words
    }
    return words
}

function value(word,    k, power) {
    word = tolower(word)
    if (!match(word, /^[0-9.]+(e[-+]?[0-9]+)?/))
        return 1
    k = substr(word, RSTART + RLENGTH, 3)
    power = k == "meg" ? 1e6 : k ~ /^g/ ? 1e9 : k ~ /^k/ ? 1e3 : k ~ /^m/ ? 1e-3 : k ~ /^u/ ? 1e-6 : k ~ /^n/ ? 1e-9 : k ~ /^p/ ? 1e-12 : 1
    return substr(word, 1, RLENGTH) * power
}

# A line after those that continue it were joined.
function take(line, from,    word, n, w) {
    n = split(line, w, /[ \t]+/)
    word = tolower(w[1])
    if (word == ".control") { in_control = 1; return }
    if (word == ".endc") { in_control = 0; return }
    if (in_control) {
        if (word == "tran" && !seen_tran) { seen_tran = 1; sub(/^[^ \t]+[ \t]+/, "", line); print ".tran " with_step(line) }
        return
    }
    if (word == ".tran" || word == ".tr") {
        if (!seen_tran) { sub(/^[^ \t]+[ \t]+/, "", line); sub(/;.*/, "", line); gsub(/ startup| steady/, "", line); print ".tran " with_step(line) }
        seen_tran = 1
        return
    }
    if (word ~ /^\.(include|inc|lib|incl)$/ && n >= 2 && from ~ /\//) {
        include(from, w[2], word == ".lib" ? w[3] : "")
        return
    }
    if (word ~ /^\.(end|ac|dc|op|noise|sens|pz|tf|print|plot|probe|save|meas|measure|four|fourier|step|backanno|wave|preprocess|result|width|data|enddata|net|sp|lin|pss|disto|prot|unprot|saveop|savebias|loadbias)$/)
        return
    if (word ~ /^\.options?$/ && tolower(w[2]) ~ /^(timeint|nonlin|linsol|device|output|parser|diagnostic|sensitivity|nonlin-tran|restart|fft|measure|loca|hbint|linsol-ac|linsol-hb|mpdeint|nonlin-hb|result|warn|plotwinsize)$/)
        return
    print line
}

function include(from, name, section,    path) {
    path = from
    sub(/[^\/]*$/, "", path)
    name = without_quotes(name)
    gsub(/\\/, "/", name)
    path = name ~ /^\// ? name : path name
    if (is_there(path) && depth < 8) { depth++; read_file(path, tolower(section), 0, 0); depth-- }
    else if (section == "" && name !~ /[:]/) print "* not there: " name
}

function read_file(path, section, is_first, wanted,    line, held, first, inside, fences, on) {
    held = ""
    first = is_first
    on = section == ""
    while ((getline line < path) > 0) {
        sub(/\r$/, "", line)
        gsub(/\302\265|\316\274|\265/, "u", line)
        if (wanted) {
            if (line ~ /^```/) { fences += !inside; inside = !inside; if (!inside && fences >= wanted) break; continue }
            if (!inside || fences != wanted) continue
        }
        if (section != "") {
            if (tolower(line) ~ "^[ \t]*\\.lib[ \t]+" section "[ \t]*$") { on = 1; continue }
            if (tolower(line) ~ /^[ \t]*\.endl/) on = 0
            if (!on) continue
        }
        if (first) { first = 0; print "* " line; if (!(wanted && line !~ /^[ \t]*\*/)) continue }
        sub(/^[ \t]+/, "", line)
        if (line == "" || line ~ /^\*/) continue
        if (line ~ /^\+/) { held = held " " substr(line, 2); continue }
        if (held != "") take(held, path)
        held = line
    }
    close(path)
    if (held != "") take(held, path)
}

BEGIN {
    read_file(ARGV[1], "", 1, block)
    exit
}
