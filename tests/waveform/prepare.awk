# prepare.awk - reads a netlist with checks (README.md): writes FOLDER/netlist, and to stdout an awk program that
# computes the formulas and writes FOLDER/meas (the meas lines), FOLDER/save and FOLDER/checks (name, expected, scale).
# -v vary="NAME=VALUE ...": instead of the .param line's; -v folder=FOLDER.
# What lines `*+` check goes to FOLDER/meas.devices and FOLDER/checks.devices.

function number(text,    value, unit) {
    value = text + 0
    unit = tolower(text)
    sub(/^[-+]?[0-9.]+(e[-+]?[0-9]+)?/, "", unit)
    if (unit == "") return value
    if (unit ~ /^meg/) return value * 1e6
    unit = index("fpnumkgt", substr(unit, 1, 1))
    return unit ? value * substr("1e-151e-121e-091e-061e-031e+031e+091e+12", 5 * unit - 4, 5) : value
}

# The text of a .meas as an awk expression: {EXPRESSION} is computed.
function spliced(text,    out, at) {
    gsub(/"/, "\\\"", text)
    out = ""
    while ((at = index(text, "{")) > 0) {
        out = out "\"" substr(text, 1, at - 1) "\" sprintf(\"%.15g\", "
        text = substr(text, at + 1)
        at = index(text, "}")
        out = out substr(text, 1, at - 1) ") "
        text = substr(text, at + 1)
    }
    return out "\"" text "\""
}

BEGIN {
    count = split(vary, pair, " ")
    for (i = 1; i <= count; i++) {
        split(pair[i], half, "=")
        given[half[1]] = half[2]
    }
    print "BEGIN {"
    print "pi = atan2(0, -1)"
    printf "meas = \"%s/meas\"; checks = \"%s/checks\"\n", folder, folder
    printf "" > (folder "/netlist")
    printf "" > (folder "/save")
    kept = "save all"
}

tolower($1) == ".param" {
    for (i = 2; i <= NF; i++) {
        split($i, half, "=")
        if (half[1] in given) {
            half[2] = given[half[1]]
            used[half[1]]
        }
        printf "%s = %.17g\n", half[1], number(half[2])
        printf ".param %s=%s\n", half[1], half[2] > (folder "/netlist")
    }
    next
}

/^\*: / { print substr($0, 4); next }

/^\*[=+2] / {
    ending = substr($0, 2, 1) == "+" ? " \".devices\"" : substr($0, 2, 1) == "2" ? " \".squares\"" : ""
    line = substr($0, 4)
    parts = split(line, field, " *; *")
    if (parts < 3) { print FILENAME ": " $0 > "/dev/stderr"; failed = 1; exit }
    gsub(/ /, "", field[1])
    printf "print \"meas tran %s \" %s > (meas%s)\n", field[1], spliced(field[2]), ending
    printf "printf \"%s %%.17g %%.17g\\n\", %s, %s > (checks%s)\n", field[1], field[3], (parts > 3 ? field[4] : field[3]), ending
    rest = field[2]
    while (match(rest, /@[a-z0-9.]+\[[a-z]+\]/)) {
        name = substr(rest, RSTART, RLENGTH)
        if (!(name in saved)) kept = kept " " name
        saved[name]
        rest = substr(rest, RSTART + RLENGTH)
    }
    next
}

# NAME ; EXPRESSION of what was measured before ; EXPECTED ; SCALE
/^\*! / {
    if (split(substr($0, 4), field, " *; *") < 4) { print FILENAME ": " $0 > "/dev/stderr"; failed = 1; exit }
    gsub(/ /, "", field[1])
    printf "print \"let %s = \" %s \"\\nprint %s\" > meas\n", field[1], spliced(field[2]), field[1]
    printf "printf \"%s %%.17g %%.17g\\n\", %s, %s > checks\n", field[1], field[3], field[4]
    next
}

/^\*\. / {
    line = substr($0, 4)
    split(line, field, " *; *")
    gsub(/ /, "", field[1])
    printf "print \"meas tran %s \" %s > meas\n", field[1], spliced(field[2])
    next
}

# besides, 100 regular points of the run
/^\*< / { printf "printf \"rows %%.17g 1\\n\", 100 + %s > checks\n", substr($0, 4); next }

/^\*/ && FNR > 1 || tolower($1) == ".end" { next }

{ print > (folder "/netlist") }

END {
    if (failed) exit 1
    for (name in given)
        if (!(name in used)) { print FILENAME ": no such .param: " name > "/dev/stderr"; exit 1 }
    if (kept != "save all") print kept > (folder "/save")
    print "printf \"\" > (meas \".devices\"); printf \"\" > (checks \".devices\")"
    print "printf \"\" > (meas \".squares\"); printf \"\" > (checks \".squares\")"
    print "}"
}
