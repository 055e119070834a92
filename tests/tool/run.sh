#!/bin/sh
# tests/tool/run.sh - nsc-mlcp: exit statuses, what it prints, what it says of bad input.
#
#     tests/tool/run.sh [PROGRAM]      build/nsc-mlcp
cd "$(dirname "$0")/../.." || exit 1
program=$PWD/${1:-build/nsc-mlcp}
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 1
status=0

# run ARGUMENT...: into out, err and got
run() {
    "$program" "$@" >out 2>err
    got=$?
}

# verdict NAME CONDITION(0: holds)
verdict() {
    if [ "$2" = 0 ]; then
        echo "ok $1"
    else
        echo "FAIL $1: exit status $got"
        head -n 20 out err
        status=1
    fi
}

# answers NAME STATUS LINE...: that exit status, nothing on stderr, and each LINE (a regular expression) is one of out.
answers() {
    name=$1 expected=$2 bad=0
    shift 2
    [ "$got" = "$expected" ] && [ ! -s err ] || bad=1
    for line in "$@"; do
        grep -qxE -e "$line" out || bad=1
    done
    verdict "$name" $bad
}

# refuses NAME LINE: exit status 3, nothing on stdout, LINE (as it stands) on stderr and nothing else.
refuses() {
    [ "$got" = 3 ] && [ ! -s out ] && [ "$(cat err)" = "nsc-mlcp: $2" ]
    verdict "$1" $?
}

# y = 0 at lambda = (4, 8): 2*4 = 8, 4 + 4*8 = 36; a triangle of short numbers, so that every method is exact.
printf '# two pairs\n2\n 2 0\n 1 4\n -8 -36\n 0 0\n inf inf\n' >two.txt
# -lambda - 1 >= 0 has no lambda >= 0.
printf '1  -1  -1  0  inf\n' >none.txt
# lambda free and y = 1 + 0 lambda = 0.
printf '1  0  1  -inf  inf\n' >contradiction.txt
# y = (lambda2 - 1, 1 - lambda1): solved by (1, 1), and neither y depends on its own lambda.
printf '2  0 1 -1 0  -1 1  0 0  inf inf\n' >rotation.txt

run two.txt
answers 'solved' 0 'status solved' 'residual [0-9.e-]+' 'lambda 4 8' 'y 0 0' 'solver [a-z]+'
for solver in auto pivot lemke enumerate; do
    run --solver $solver two.txt
    awk '$1 == "lambda" {good = ($2 - 4) ^ 2 + ($3 - 8) ^ 2 < 1e-18} END {exit !good}' out && [ "$got" = 0 ]
    verdict "solved by $solver" $?
    [ $solver = auto ] || { grep -qx "solver $solver" out; verdict "$solver says its name" $?; }
done
run --solver=lemke two.txt
answers '--solver=NAME' 0 'lambda 4 8' 'solver lemke'
run two.txt --solver lemke
answers 'an option behind FILE' 0 'solver lemke'
run - <two.txt
answers 'standard input' 0 'lambda 4 8'
cp two.txt ./--odd
run -- --odd
answers 'a name that looks like an option' 0 'lambda 4 8'
printf '0\n' >empty.txt
run empty.txt
answers 'no pairs' 0 'status solved' 'residual 0' 'lambda' 'y'

run none.txt
answers 'no solution' 1 'status no-solution' 'certified yes' 'margin [0-9.e-]+' 'certificate [-0-9.e]+' 'solver [a-z]+'
awk '$1 == "margin" {good = $2 > 0} END {exit !good}' out
verdict 'the margin is above 0' $?
run contradiction.txt
answers 'equations that contradict' 1 'status no-solution' 'certified yes'

awk 'BEGIN {print 17; for (i = 0; i < 17 * 17; i++) print i % 18 == 0; for (k = 0; k < 51; k++) print k < 17 ? -1 : k < 34 ? 0 : "inf"}' >unit.txt
run --solver enumerate unit.txt
answers 'gave up' 2 'status gave-up' 'solver enumerate' 'why a size or an index is out of range'
printf '1\n1e200\n-1e-150\n0\ninf\n' >tiny.txt
run tiny.txt
answers 'an answer below every double' 2 'status gave-up' 'why the iteration bound was met'
run rotation.txt
answers 'no diagonal' 0 'lambda 1 1'

run --help
answers '--help' 0 'usage: nsc-mlcp .*' '--solver NAME .* auto pivot lemke enumerate' 'Exit status: .*'

run
refuses 'no arguments' 'no FILE; --help tells'
run two.txt none.txt
refuses 'two files' "one FILE, please: 'none.txt' is the second"
run --fast two.txt
refuses 'an unknown option' "unknown option '--fast'; --help tells"
run two.txt --solver
refuses '--solver without a name' '--solver needs the name of one'
run --solver simplex two.txt
refuses 'an unknown solver' "no solver is named 'simplex'; --help tells"
run absent.txt
refuses 'no such file' 'absent.txt: No such file or directory'
run .
refuses 'a folder' '.: Is a directory'
printf '2\n1 2\n3 4..0\n' >bad.txt
run bad.txt
refuses 'a number that is none' "bad.txt:3: W(2,2) is '4..0', which is no number"
printf '1\n1\n0\n0\n' >short.txt
run - <short.txt
refuses 'a text that ends early' 'standard input:4: the text ends before u(1), after 3 of 4 numbers'
printf '1 1 0 2 1' >bounds.txt
run bounds.txt
refuses 'bounds that exclude all' 'bounds.txt:1: l(1) = 2 is above u(1) = 1'
if [ -c /dev/full ]; then
    "$program" two.txt >/dev/full 2>err
    got=$?
    : >out
    refuses 'an output that is full' 'standard output: No space left on device'
fi
exit $status
