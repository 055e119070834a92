# tests/corpus/goals.awk - counts the verdicts of run.sh; exit status 1 if a goal is missed.

$1 == "native" {
    native++
    if ($3 != "-") { compared++; agree += $3 <= 5 }
    if ($4 != "-") { with_own++; agree_own += $4 <= 5 }
    if ($6 != "-" && $5 > $6 + 0.02) { slower++; slow = slow " " $2 } # 0.02 s: of starting
}
$1 == "refused" { refused++ }
$1 == "failed" { failed++ }
$1 != "absent" { all++ }

function goal(text, is, of, wanted) {
    met = of > 0 && is >= wanted * of
    missed += !met
    printf "%s %s: %d of %d\n", met ? "reached" : "MISSED", text, is, of
}

END {
    goal("run natively (70 %)", native, all, 0.7)
    goal("agree with the smooth models of the same vf, ron, roff at every node within 5 % (90 %)", agree, compared, 0.9)
    goal("are no slower than ngspice", native - slower, native, 1)
    printf "%d of %d agree with ngspice's own D; %d refused, %d failed%s\n", agree_own, with_own, refused, failed, slow ? "; slower:" slow : ""
    exit missed > 0
}
