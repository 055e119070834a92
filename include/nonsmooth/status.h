/* nonsmooth/status.h - status codes and their texts, in one table; what a failed call reports. */
#ifndef NONSMOOTH_STATUS_H
#define NONSMOOTH_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* X(name, value, text).  Positive: nothing changed, call again with a smaller step.  Negative: an error. */
#define NS_STATUS_TABLE(X)                                                                                   \
    X(NS_OK, 0, "ok")                                                                                        \
    X(NS_GUARD, 1, "a guard of the present mode broke inside the step")                                      \
    X(NS_DIVERGED, 2, "the Newton loop of a step did not converge")                                          \
    X(NS_E_NULL, -1, "a required pointer is NULL")                                                           \
    X(NS_E_SIZE, -2, "a size or an index is out of range")                                                   \
    X(NS_E_NUMBER, -3, "a number is NaN, or infinite where it must be finite")                               \
    X(NS_E_RANGE, -4, "a parameter is outside its range")                                                    \
    X(NS_E_BOUNDS, -5, "a lower bound lies above its upper bound")                                           \
    X(NS_E_MEMORY, -6, "out of memory")                                                                      \
    X(NS_E_SINGULAR, -7, "the equations do not determine the answer")                                        \
    X(NS_E_INFEASIBLE, -8, "no solution exists")                                                             \
    X(NS_E_LIMIT, -9, "gave up: the iteration bound was met")                                                \
    X(NS_E_RESIDUAL, -10, "the answer found does not satisfy the equations")                                 \
    X(NS_E_OVERFLOW, -11, "the solution grew beyond what a double can hold")                                 \
    X(NS_E_STATE, -12, "this call does not fit the state of the object")                                     \
    X(NS_E_NAME, -13, "a name is unknown or given twice")                                                    \
    X(NS_E_CHATTER, -14, "a switch without hysteresis opens and closes infinitely fast")

typedef enum ns_status {
#define NS_STATUS_ENUM(name, value, text) name = value,
    NS_STATUS_TABLE(NS_STATUS_ENUM)
#undef NS_STATUS_ENUM
} ns_status;

/* The text of a status, a constant string; "unknown status" for a value outside the table. */
const char *ns_status_text(int status);

/* The name of a status ("NS_OK"), a constant string; "?" for a value outside the table. */
const char *ns_status_name(int status);

enum { NS_FAULT_MAX = 8 };

/* What a failed call reports.  Indices are those of the system that failed;
 * ns_circuit_explain() turns them into names. */
typedef struct ns_fault {
    ns_status status;
    double t;                  /* time, s; NAN where there is none */
    int npairs;                /* how many entries of pair[] hold */
    int pair[NS_FAULT_MAX];    /* complementarity pairs that contradict each other */
    int nunknowns;             /* how many entries of unknown[] hold */
    int unknown[NS_FAULT_MAX]; /* unknowns (entries of x) that are not determined; rows of the system that
                                  contradict, by the unknown of their index: a node's KCL, a branch's law */
    const char *why;           /* constant string: what is wrong with an answer; NULL: nothing is said */
} ns_fault;

#ifdef __cplusplus
}
#endif
#endif
