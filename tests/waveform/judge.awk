# judge.awk - the checks of one circuit against the output of one run: one line a check, to stdout.
# Two files: checks (name, expected, scale), and what ngspice printed.  -v label=... -v run=...

function verdict(good, text) { print (good ? "ok" : "FAIL") " " label " run " run " " text }
function magnitude(x) { return x < 0 ? -x : x }

FNR == NR { names[++count] = $1; expected[$1] = $2; scale[$1] = magnitude($3); next }
$2 == "=" && ($1 in expected) { got[$1] = $3 }
/^No. of Data Rows :/ { rows = $NF }
/^status / && $2 != 0 { why = "status " $2 }
/timestep too small|singular|^nonsmooth: .*(gave up|no solution|not supported)/ && why == "" { why = $0 }
/^Timestep too small|rror: / && why == "" && !/measure/ { why = $0 }

END {
    if (why != "") verdict(0, why)
    tolerance = run == "devices" ? 1e-5 : run == "fine" ? 1e-4 : 1e-3
    for (i = 1; i <= count; i++) {
        name = names[i]
        if (name == "rows") {
            if (run != "grid" && run != "fine")
                verdict(rows != "" && rows <= expected[name], sprintf("rows at most %d, got %s", expected[name], rows))
            continue
        }
        if (run == "grid" || run == "theta") continue
        if (!(name in got)) { verdict(0, name " expected " expected[name] " error nothing"); continue }
        error = magnitude(got[name] - expected[name]) / scale[name]
        verdict(error <= tolerance, sprintf("%s expected %.8g got %.8g error %.2g", name, expected[name], got[name], error))
    }
}
