#!/bin/sh
# codemodels/mingw-libraries.sh - the routines of LAPACK, BLAS and KLU that the library uses, for Windows.
#
#     codemodels/mingw-libraries.sh DIR ROUTINE...
#
# From the system's source packages, by MinGW's compilers: DIR/libnumeric.a and DIR/include.  Of LAPACK and BLAS
# only what the ROUTINEs call; of SuiteSparse all of KLU, BTF, AMD and COLAMD.
set -eu

dir=$1
shift
wanted=$*
CC=x86_64-w64-mingw32-gcc
FC=x86_64-w64-mingw32-gfortran
NM=x86_64-w64-mingw32-nm
AR=x86_64-w64-mingw32-ar
here=$(cd "$(dirname "$0")" && pwd)

if [ "$(cat "$dir/stamp" 2>/dev/null)" = "$wanted" ]; then
    exit 0
fi

for package in lapack suitesparse; do
    [ -d "$dir/$package/tree" ] || "$here/source-package.sh" "$dir/$package" $package
done
cd "$dir"
rm -rf objects include libnumeric.a
mkdir -p objects include/suitesparse
lapack=lapack/tree
cp $lapack/LAPACKE/include/*.h include
cp $lapack/LAPACKE/include/lapacke_mangling_with_flags.h.in include/lapacke_mangling.h
for part in SuiteSparse_config KLU/Include BTF/Include AMD/Include COLAMD/Include; do
    cp suitesparse/tree/$part/*.h include/suitesparse
done

# made FILE: compiles it, unless that was done.
made() {
    object=objects/$(basename "${1%.*}").o
    [ ! -f "$object" ] || return 0
    case $1 in
    *.c) $CC -O2 -w -Iinclude -Iinclude/suitesparse -c "$1" -o "$object" ;;
    *) $FC -O2 -w -fno-second-underscore -J objects -c "$1" -o "$object" ;;
    esac
}

# file SYMBOL: the source of a routine of LAPACK, BLAS or LAPACKE; nothing if it is none.
file() {
    low=$(echo "${1%_}" | tr '[:upper:]' '[:lower:]')
    for f in "$lapack/SRC/$low".f "$lapack/SRC/$low".f90 "$lapack/BLAS/SRC/$low".f "$lapack/BLAS/SRC/$low".f90 \
        "$lapack/INSTALL/$low".f "$lapack/LAPACKE/src/$low".c "$lapack/LAPACKE/utils/$low".c; do
        if [ -f "$f" ]; then
            echo "$f"
            return
        fi
    done
}

# missing: symbols that objects want and do not have.
missing() {
    $NM -u objects/*.o | awk '/ U / {print $2}' | sort -u >needed
    $NM --defined-only objects/*.o | awk 'NF == 3 {print $3}' | sort -u >there
    comm -23 needed there
}

made $lapack/SRC/la_constants.f90 # modules of others
made $lapack/SRC/la_xisnan.F90
made $lapack/LAPACKE/src/lapacke_nancheck.c
made "$here/bridge/fortran.c" # in place of Fortran's run time
for routine in $wanted; do
    made "$(file "$routine")"
done
while :; do # ends: each round compiles a file at least
    before=$(find objects -name '*.o' | wc -l)
    for symbol in $(missing); do
        f=$(file "$symbol")
        [ -z "$f" ] || [ "$symbol" = xerbla_ ] || made "$f"
    done
    [ "$(find objects -name '*.o' | wc -l)" -gt "$before" ] || break
done
for f in suitesparse/tree/KLU/Source/*.c suitesparse/tree/BTF/Source/*.c suitesparse/tree/AMD/Source/*.c \
    suitesparse/tree/COLAMD/Source/colamd.c suitesparse/tree/SuiteSparse_config/SuiteSparse_config.c; do
    made "$f"
done
$AR rcs libnumeric.a objects/*.o
echo "$wanted" >stamp
