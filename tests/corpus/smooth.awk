# tests/corpus/smooth.awk - the netlist with each D as ngspice's smooth model of the vf, ron and breakdown that it was taken with;
# where two lines stand for its curve, as two in parallel.
#
#     awk -f smooth.awk OUTPUT NETLIST    OUTPUT: of the native run, which says them for each model

function seconds(word,    k) {
    word = tolower(word)
    if (!match(word, /^[0-9.]+(e[-+]?[0-9]+)?/))
        return 0
    k = substr(word, RSTART + RLENGTH, 3)
    return substr(word, 1, RLENGTH) * (k == "meg" ? 1e6 : k ~ /^g/ ? 1e9 : k ~ /^k/ ? 1e3 : k ~ /^m/ ? 1e-3 : k ~ /^u/ ? 1e-6 : k ~ /^n/ ? 1e-9 : k ~ /^p/ ? 1e-12 : 1)
}

# vf, ron, vz, rz, and the second line, of the words from the i-th on; of the first D of a model, if there are several
function remember(name, i) {
    if (name in vf) return
    for (; i < NF; i++) {
        if ($i == "above") { rush_vf[name] = $(i + 1); rush_ron[name] = 1 / (1 / $(i + 3) - 1 / ron[name]) }
        if ($i == "vf" && !(name in vf)) vf[name] = $(i + 2)
        if ($i == "ron" && !(name in ron)) ron[name] = $(i + 2) < 1e-6 ? 1e-6 : $(i + 2)
        if ($i == "breakdown" && !(name in vz)) { vz[name] = $(i + 2); rz[name] = $(i + 4) == "with" ? $(i + 5) : ron[name] }
    }
}

function write_model(word, name) {
    printf ".model %s sidiode(vfwd=%s ron=%s roff=1e12%s)\n", word, vf[name], ron[name],
        name in vz ? " vrev=" vz[name] " rrev=" rz[name] : ""
    if (name in rush_vf) printf ".model %s_rush sidiode(vfwd=%s ron=%.6g roff=1e12)\n", word, rush_vf[name], rush_ron[name]
}

function write_diode(model, name) {
    print "a" $1, $2, $3, model
    if (name in rush_vf) print "a" $1 "_rush", $2, $3, model "_rush"
}

FNR == NR {
    if ($1 == "nonsmooth:" && $2 == "D" && $3 == "of" && $4 == "model") {
        name = $5
        sub(/:$/, "", name)
        sub(/.*:/, "", name) # of a subcircuit: x1:dm
        for (i = 6; i < NF && $i != "taken"; i++) { # names of D, or how many
            gsub(/,/, "", $i)
            if ($i ~ /^d/) model_of[$i] = name "_" NR
        }
        remember(name, i)
        remember(name "_" NR, i)
    }
    next
}

# 5000 steps at least, so that the reference is one, none longer than tstep: as it is, it has no longer ones
tolower($1) == ".tran" {
    line = $0
    sub(/;.*/, "", line)
    n = split(line, w, /[ \t]+/)
    if (w[n] ~ /^[uU][iI][cC]$/) { uic = " uic"; n-- }
    most = seconds(w[3]) / 5000
    if (seconds(w[2]) > 0 && seconds(w[2]) < most) most = seconds(w[2])
    if (seconds(w[2]) && n >= 3 && w[3] ~ /^[.0-9]/) {
        if (n >= 5 && seconds(w[5]) < most) most = seconds(w[5])
        print ".tran", w[2], w[3], (n >= 4 ? w[4] : 0), most uic
        next
    }
}

{ name = tolower($2); sub(/\(.*/, "", name) }

tolower($1) == ".model" && name in vf {
    write_model($2, name)
    next
}

tolower($1) ~ /^d/ && tolower($1) in model_of && tolower($4) in vf {
    own = "own_" tolower($1)
    write_diode(own, model_of[tolower($1)])
    write_model(own, model_of[tolower($1)])
    next
}

tolower($1) ~ /^d/ && tolower($4) in vf { write_diode($4, tolower($4)); next }

{ print }
