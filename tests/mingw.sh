#!/bin/sh
# tests/mingw.sh - what `make mingw` made for Windows: is it whole, and does nsc-mlcp.exe pass its tests under wine?
#
#     tests/mingw.sh FOLDER
#
# Verdicts `ok NAME`, `FAIL NAME reason`, `skip NAME reason`; exit status 1 if one failed.
cd "$(dirname "$0")/.." || exit 2
made=$PWD/$1
status=0

verdict() {
    if [ -z "$2" ]; then echo "ok mingw/$1"; else
        echo "FAIL mingw/$1 $2"
        status=1
    fi
}

# exports FILE NAME...: prints a name that the library does not show.
exports() {
    x86_64-w64-mingw32-objdump -p "$1" | awk '/\[Ordinal\/Name Pointer\]/ {on = 1} on && /^\t*\[/ {print $NF}' >"$made/exports"
    shift
    for name; do grep -qx "$name" "$made/exports" || { echo "does not show $name" && return; }; done
}

# needs FILE: prints libraries that are not Windows' own.
needs() {
    x86_64-w64-mingw32-objdump -p "$1" | sed -n 's/^\tDLL Name: //p' | grep -v -i -E '^(kernel32|msvcrt|user32|api-ms-.*)\.dll$' |
        sed 's/^/needs /' | tr '\n' ' '
}

verdict nonsmooth.dll "$(exports "$made/nonsmooth.dll" ns_mlcp_solve ns_circuit_create ns_march_try)$(needs "$made/nonsmooth.dll")"
for cm in nonsmooth.cm chooser/nonsmooth.cm; do
    verdict "$cm" "$(exports "$made/$cm" CMdevs CMdevNum CMudns CMudnNum CMgetCoreItfPtr)$(needs "$made/$cm")"
done
verdict nsc-mlcp.exe "$(needs "$made/nsc-mlcp.exe")"
for wine in wine64 wine /usr/lib/wine/wine64 ''; do
    if [ -z "$wine" ] || command -v "$wine" >/dev/null; then break; fi
done
if [ -z "$wine" ]; then
    echo 'skip mingw/tool there is no wine'
    exit $status
fi
# Its lines end as Windows' do.
cat >"$made/nsc-mlcp-by-wine" <<END
#!/bin/sh
export WINEDEBUG=-all WINEPREFIX='$made/wine'
said=\$(mktemp -d) || exit 99
$wine '$made/nsc-mlcp.exe' "\$@" >"\$said/out" 2>"\$said/err"
status=\$?
tr -d '\\r' <"\$said/out"
tr -d '\\r' <"\$said/err" >&2
rm -rf "\$said"
exit \$status
END
chmod +x "$made/nsc-mlcp-by-wine"
"$made/nsc-mlcp-by-wine" --help >/dev/null 2>&1 # makes its folder
tests/tool/run.sh "$1/nsc-mlcp-by-wine" >"$made/tool"
# Windows calls a folder something that may not be opened, and has no /dev/full.
sed -E -e 's/^FAIL (a folder|an output that is full):.*/skip \1: as on Unix only/' -e 's/^(ok|FAIL|skip) /\1 mingw\/tool /' "$made/tool" |
    grep -E '^(ok|FAIL|skip) ' | tee "$made/verdicts"
! grep -q '^FAIL' "$made/verdicts" && [ "$(grep -c '^ok' "$made/verdicts")" -gt 20 ] || status=1
exit $status
