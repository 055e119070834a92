/* src/linalg/directions.h - directions at right angles to each other: a vector without what lies along them,
 * and other directions of the same space, of which what a matrix makes is at right angles too.
 *
 * Q: count directions (size each), one behind the other, of length 1 and at right angles.
 */
#ifndef NS_LINALG_DIRECTIONS_H
#define NS_LINALG_DIRECTIONS_H

#include <stddef.h>

/* Takes out of x (size) what lies along Q; along (count): how much, with its sign changed. */
void ns_linalg_leave(int size, int count, const double *Q, double *x, double *along);

/* The same twice, which leaves no more than rounding, and makes the length of x 1.  Returns its length before
 * that. */
double ns_linalg_straighten(int size, int count, const double *Q, double *x, double *along);

/* Numbers that ns_linalg_turn() needs as room. */
size_t ns_linalg_turn_room(int size, int count);

/* Turns Q within the space it spans, until what a matrix makes of each is at right angles to what it makes of
 * the others: then the space holds what the matrix takes to nothing as directions of their own.  image: count
 * vectors (size), what it makes of Q; length (count): how long they are after the turn. */
void ns_linalg_turn(int size, int count, double *Q, const double *image, double *length, double *room);

#endif
