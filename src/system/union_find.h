/* src/system/union_find.h - sets of integers that are united; each set is represented by its least member. */
#ifndef NS_SYSTEM_UNION_FIND_H
#define NS_SYSTEM_UNION_FIND_H

/* of[i]: i itself where it is the least of its set, else a smaller member. */
static inline void ns_system_union_begin(int *of, int count) {
    for (int i = 0; i < count; i++)
        of[i] = i;
}

static inline int ns_system_union_top(int *of, int i) {
    while (of[i] != i) /* NOLINT(clang-analyzer-core.UndefinedBinaryOperatorResult): all are set */
        i = of[i] = of[of[i]];
    return i;
}

static inline void ns_system_union_join(int *of, int i, int j) {
    const int a = ns_system_union_top(of, i), b = ns_system_union_top(of, j);
    if (a != b)
        of[a < b ? b : a] = a < b ? a : b;
}

#endif
