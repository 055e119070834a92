/* bridge/fortran.c - what LAPACK's archive wants of Fortran's run time, which then need not be loaded. */
#include <stddef.h>
#include <string.h>

/* LAPACK's complaint about an argument.  It leaves its caller a status as well, and ours looks at that; the
 * one of the archive writes a line and ends ngspice. */
void xerbla_(const char *routine, const int *argument, size_t length);
void xerbla_(const char *routine, const int *argument, size_t length) {
    (void)routine;
    (void)argument;
    (void)length;
}

/* to = a // b: gfortran's own name and order. */
void concat(size_t size, char *to, size_t na, const char *a, size_t nb,
            const char *b) __asm__("_gfortran_concat_string");
void concat(size_t size, char *to, size_t na, const char *a, size_t nb, const char *b) {
    const size_t first = na < size ? na : size;
    const size_t second = nb < size - first ? nb : size - first;
    memcpy(to, a, first);
    memcpy(to + first, b, second);
    memset(to + first + second, ' ', size - first - second);
}
