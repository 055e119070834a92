/* nonsmooth/text.h - a problem (P1) as plain text, read from and written to memory:
 *
 *   m         the number of pairs, an integer >= 0
 *   W         m*m numbers, row by row
 *   q  l  u   m numbers each
 *
 * separated by white space; # starts a comment, to the end of its line.  Numbers are decimal, as in C.  They
 * are read as the nearest double: one too small for a double as 0, one too large is refused, as is NaN. Among
 * l and u, inf and -inf are allowed.  The decimal point is a point whatever locale the program has set.
 * Messages count lines, rows and columns from 1.
 */
#ifndef NONSMOOTH_TEXT_H
#define NONSMOOTH_TEXT_H

#include <stddef.h>

#include "nonsmooth/mlcp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Why a text was refused; plain data. */
typedef struct ns_text_fault {
    long line;       /* where, from 1; 0: the reason is not in the text */
    char cause[160]; /* in one line of printable characters: "W(2,3) is '1..5', which is no number" */
} ns_text_fault;

/* Reads a problem from text (length bytes; need not be terminated).  No more memory is taken than some
 * twenty times the length.  On failure *out is NULL and fault (may be NULL) says why.
 * Errors: NULL, SIZE (m, or how many numbers there are), NUMBER, BOUNDS (l > u, or both the same infinity),
 * MEMORY. */
int ns_mlcp_read(const char *text, size_t length, ns_mlcp **out, ns_text_fault *fault);

/* Frees a problem that ns_mlcp_read() made; NULL is allowed. */
void ns_mlcp_discard(ns_mlcp *p);

/* Writes p, whose W must not be NULL but for m = 0, such that ns_mlcp_read() gives back its very numbers,
 * each with as few digits as that takes.  text gets at most size bytes, the last of them '\0' (NULL with size
 * 0 is allowed); *length gets the number of characters that all of it has: if that is not below size, it was
 * cut.  Errors: NULL, SIZE, NUMBER, BOUNDS (as ns_mlcp_solve()), MEMORY. */
int ns_mlcp_write(const ns_mlcp *p, char *text, size_t size, size_t *length);

#ifdef __cplusplus
}
#endif
#endif
