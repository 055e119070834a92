# tests/mutants/candidates.awk - every small change that a mutant may be, of formatted C files.
#
#     awk -f candidates.awk FILE...
#
# Lines "PLACE <tab> FILE <tab> LINE <tab> FUNCTION <tab> BEFORE <tab> AFTER": the line without its indentation; changes
# of one place of the text have the same number PLACE.  Only inside functions, never in comments, strings or lines of
# the preprocessor.
BEGIN {
    split("<= >= == != && || += -= *= /= ++ --", two, " ")
    for (k in two) doubled[two[k]] = 1
    other["<"] = "<= >="; other["<="] = "< >"; other[">"] = ">= <="; other[">="] = "> <"
    other["=="] = "!="; other["!="] = "=="; other["&&"] = "||"; other["||"] = "&&"
    other["+"] = "-"; other["-"] = "+"; other["*"] = "/"; other["/"] = "*"
    other["+="] = "-="; other["-="] = "+="; other["*="] = "/="; other["/="] = "*="
    other["++"] = "--"; other["--"] = "++"
}

# The line with comments, strings and characters blanked; `comment` goes on into the next line.
function blank(line,    out, c, k, quote) {
    out = ""
    for (k = 1; k <= length(line); k++) {
        c = substr(line, k, 1)
        if (comment) {
            if (substr(line, k, 2) == "*/") {comment = 0; k++; out = out " "}
            out = out " "
        } else if (quote != "") {
            if (c == "\\") {k++; out = out " "}
            else if (c == quote) quote = ""
            out = out " "
        } else if (substr(line, k, 2) == "/*") {
            comment = 1; k++; out = out "  "
        } else if (c == "\"" || c == "\047") {
            quote = c; out = out " "
        } else out = out c
    }
    return out
}

# The text of `size` letters from column `at` of the line becomes `new`.
function change(at, size, new,    before, after) {
    before = $0
    after = substr($0, 1, at - 1) new substr($0, at + size)
    sub(/^ +/, "", before); sub(/^ +/, "", after)
    print place "\t" FILENAME "\t" FNR "\t" function_name "\t" before "\t" after
}

function number(at, text) {
    if (text ~ /^[0-9]+$/) {
        if ($0 !~ /alloc\(/) change(at, length(text), text + 1) # more memory than needed is no fault
        change(at, length(text), text == "0" ? "2" : text - 1)
    } else if (text ~ /^[0-9]*\.?[0-9]*(e[-+]?[0-9]+)?$/) {
        if (text + 0 == 0) change(at, length(text), "1.0")
        else change(at, length(text), sprintf("(2 * %s)", text))
    }
}

function operators(code,    k, c, op, prev, next_char, n, alternatives, part) {
    for (k = 1; k <= length(code); k++) {
        c = substr(code, k, 1)
        prev = k > 1 ? substr(code, k - 1, 1) : " "
        if (c ~ /[0-9]/ && prev !~ /[A-Za-z0-9_.]/) {
            match(substr(code, k), /^[0-9]*\.?[0-9]*(e[-+]?[0-9]+)?[A-Za-z0-9_]*/)
            place++
            number(k, substr(code, k, RLENGTH))
            k += RLENGTH - 1
            continue
        }
        op = substr(code, k, 2)
        if (op == "->" || op == "<<" || op == ">>" || op == "%=" || op == "|=" || op == "&=") {k++; continue}
        if (!(op in doubled)) op = c
        next_char = substr(code, k + length(op), 1)
        if (c == "!" && op != "!=") {place++; change(k, 1, "")}
        else if (c == "-" && op == "-" && next_char ~ /[A-Za-z0-9_(*]/ && prev ~ /[ (]/) {place++; change(k, 1, "")}
        else if (op in other && (length(op) == 2 || (prev == " " && (next_char == " " || k == length(code))))) {
            place++
            n = split(other[op], alternatives, " ")
            for (part = 1; part <= n; part++) change(k, length(op), alternatives[part])
        }
        k += length(op) - 1
    }
}

function statement(code) {
    if (code ~ /^ +return 0;/) {place++; change(index(code, "0"), 1, "1")}
    else if (code ~ /^ +return 1;/) {place++; change(index(code, "1"), 1, "0")}
    else if (code ~ /^ +return NS_OK;/) {place++; change(index(code, "NS_OK"), 5, "NS_E_LIMIT")}
    else if (code ~ /^ +return NS_E_[A-Z]+;/) {
        place++
        match(code, /NS_E_[A-Z]+/)
        change(RSTART, RLENGTH, "NS_OK")
    } else if (code ~ /^ +(\(void\))?[a-z_0-9]+\(.*\); *$/ && code !~ /^ +(return|sizeof)/) {
        place++
        match(code, /[^ ]/)
        change(RSTART, length($0) - RSTART + 1, ";")
    }
}

FNR == 1 {comment = 0; inside = 0; function_name = ""; preprocessor = 0}
{
    text = blank($0)
    if (preprocessor || text ~ /^#/) {preprocessor = $0 ~ /\\$/; next}
}
/^[a-z].*\(/ && !/;$/ {
    function_name = text
    sub(/\(.*/, "", function_name)
    sub(/.*[ *]/, "", function_name)
}
!inside && text ~ /\{ *$/ && text !~ /= \{ *$/ && text !~ /^(typedef |static |const )*(struct|enum|union)( [a-z_0-9]+)? \{/ {
    inside = 1
    next
}
/^\}/ {inside = 0; next}
inside {
    operators(text)
    statement(text)
}
