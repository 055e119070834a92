/* tests/rig/generators.c - the classes of random problems: which matrix, which laws, which answer. */
#include "generators.h"

#include <math.h>
#include <string.h>

#include "infeasible.h"
#include "matrices.h"

static const char *const names[ALL_CLASSES] = {"P",     "passive",    "copositive", "M",    "degenerate",
                                               "boxes", "equalities", "mixed",      "near", "infeasible"};
static const double SPOIL = 0.25; /* part of the problems that are written in wild units */
enum { BOUNDS = LAW_PAIR | LAW_SHIFTED | LAW_REVERSED | LAW_BOX | LAW_RELAY | LAW_FIXED };

const char *generator_name(int class) {
    return class >= 0 && class < ALL_CLASSES ? names[class] : "?";
}

int generator_of(const char *name) {
    for (int k = 0; k < ALL_CLASSES; k++)
        if (strcmp(name, names[k]) == 0)
            return k;
    return -1;
}

static int at_most(int m, int most) {
    return m < most ? m : most;
}

static void p_matrix(sample *s, int m) {
    dice *d = &s->dice;
    int kind = dice_below(d, 8);
    /* Cauchy's and Pascal's lose a digit or two of lambda with every pair */
    sample_start(s, kind == 4 ? at_most(m, 7) : kind == 6 ? at_most(m, 9) : m);
    static const char *const said[] = {"dominant",   "barely dominant", "definite, skew part",
                                       "triangular", "Cauchy",          "min(i,j)",
                                       "Pascal",     "inverse"};
    s->kind = said[kind];
    s->unique = 1;
    if (kind < 2)
        matrix_dominant(s, kind ? dice_decades(d, -4, 0) : 1, dice_uniform(d));
    else if (kind == 2)
        matrix_definite(s, dice_decades(d, -6, 0), dice_below(d, 3));
    else if (kind == 3)
        matrix_triangular(s);
    else if (kind < 7)
        matrix_totally_positive(s, kind - 4);
    else
        matrix_inverse_dominant(s);
}

static void make_p(sample *s, int m) {
    p_matrix(s, m);
    if (dice_below(&s->dice, 4) == 0)
        matrix_scale(s, 2);
    sample_draw_all(s, LAW_PAIR, dice_below(&s->dice, 2) ? 0 : 0.1);
    sample_finish(s, SPOIL);
}

static void m_matrix(sample *s, int m) {
    dice *d = &s->dice;
    int kind = dice_below(d, 7);
    static const char *const said[] = {"dominant M", "Stieltjes", "weakly dominant", "grid",
                                       "Leontief",   "floating",  "scaled M"};
    sample_start(s, m);
    s->kind = said[kind];
    s->unique = kind != 5;
    if (kind == 0 || kind == 6)
        matrix_m_dominant(s, dice_decades(d, -3, 0), dice_uniform(d));
    else if (kind == 1)
        matrix_laplacian(s, -3, 3, 1 + dice_below(d, m));
    else if (kind == 2)
        matrix_laplacian(s, -1, 1, 1);
    else if (kind == 3)
        matrix_grid(s, dice_below(d, 2) ? 0 : dice_uniform(d));
    else if (kind == 4)
        matrix_leontief(s);
    else
        matrix_laplacian(s, -2, 2, 0);
    if (kind == 6)
        matrix_scale(s, 2);
}

static void make_m(sample *s, int m) {
    m_matrix(s, m);
    sample_draw_all(s, LAW_PAIR, dice_below(&s->dice, 2) ? 0 : 0.2);
    sample_finish(s, SPOIL);
}

static void copositive_matrix(sample *s, int m) {
    dice *d = &s->dice;
    int kind = dice_below(d, 5), short_numbers = dice_below(d, 3) == 0;
    static const char *const said[] = {"nonnegative + V V'", "nonnegative + skew", "program, copositive",
                                       "program, convex", "blocks"};
    sample_start(s, m);
    s->kind = said[kind];
    s->exact = short_numbers;
    if (kind == 0)
        matrix_strictly_copositive(s, dice_below(d, m + 1));
    else if (kind == 1)
        matrix_strictly_copositive(s, 0);
    else if (kind < 4)
        matrix_program(s, 1 + dice_below(d, m), kind == 2);
    else
        matrix_blocks(s, dice_below(d, m + 1));
    if (kind == 1)
        matrix_add_skew(s);
}

static void make_copositive(sample *s, int m) {
    copositive_matrix(s, m);
    sample_draw_all(s, LAW_PAIR, 0.1);
    sample_finish(s, SPOIL);
}

/* Rows and columns come several times over. */
static void repeat(sample *s) {
    int m = s->m, few = 1 + dice_below(&s->dice, m);
    memcpy(s->work2, s->W, (size_t)m * (size_t)m * sizeof *s->W);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++)
            *sample_entry(s, i, j) = s->work2[i % few + (j % few) * m];
}

static void degenerate_matrix(sample *s, int m) {
    dice *d = &s->dice;
    int kind = dice_below(d, 7);
    static const char *const said[] = {"short semidefinite", "short dominant", "linear program",
                                       "equal rows",         "zero",           "short M",
                                       "short program"};
    sample_start(s, m);
    s->kind = said[kind];
    s->exact = 1;
    if (kind == 0 || kind == 3)
        matrix_semidefinite(s, dice_below(d, m + 1), dice_below(d, 2));
    else if (kind == 1)
        matrix_dominant(s, 1, dice_uniform(d));
    else if (kind == 2 || kind == 6)
        matrix_program(s, 1 + dice_below(d, m), 0);
    else if (kind == 5)
        matrix_laplacian(s, 0, 0, dice_below(d, 3));
    if (kind == 2) /* no Q */
        for (int i = 0; i < m; i++)
            for (int j = 0; j <= i; j++)
                if (*sample_entry(s, i, j) != -*sample_entry(s, j, i))
                    *sample_entry(s, i, j) = *sample_entry(s, j, i) = 0;
    if (kind == 3)
        repeat(s);
}

static void make_degenerate(sample *s, int m) {
    static const double ties[] = {0.2, 0.5, 0.9, 1};
    degenerate_matrix(s, m);
    sample_draw_all(s, LAW_PAIR, ties[dice_below(&s->dice, 4)]);
    sample_finish(s, SPOIL);
}

/* A P-matrix or a monotone one: with either, what has an answer is solvable under any bounds. */
static void box_matrix(sample *s, int m) {
    int kind = dice_below(&s->dice, 5);
    if (kind == 0)
        p_matrix(s, m);
    else if (kind == 1)
        m_matrix(s, m);
    else if (kind == 2 || kind == 3) {
        sample_start(s, m);
        s->exact = kind == 2;
        s->kind = kind == 2 ? "short semidefinite" : "semidefinite";
        matrix_semidefinite(s, dice_below(&s->dice, m + 1), dice_below(&s->dice, 2));
    } else {
        sample_start(s, m);
        s->exact = 1;
        s->kind = "program";
        matrix_program(s, 1 + dice_below(&s->dice, m), 0);
    }
}

static void make_boxes(sample *s, int m) {
    static const int laws[] = {LAW_RELAY, LAW_BOX, LAW_BOX | LAW_FIXED, LAW_REVERSED | LAW_SHIFTED, BOUNDS};
    box_matrix(s, m);
    sample_draw_all(s, laws[dice_below(&s->dice, 5)], dice_below(&s->dice, 2) ? 0 : 0.3);
    sample_finish(s, SPOIL);
}

/* [Q -A'; A 0] with n unknowns, of which the rows of A are equalities, some of them sums of others. */
static void saddle(sample *s, int m) {
    dice *d = &s->dice;
    int n = 1 + dice_below(d, m), redundant = m > n + 1 && dice_below(d, 2);
    sample_start(s, m);
    s->exact = dice_below(d, 4) != 0;
    s->kind = redundant ? "saddle, redundant rows" : "saddle";
    matrix_program(s, n, 0);
    for (int i = n + 2; redundant && i < m; i += 1 + dice_below(d, 3))
        for (int j = 0; j < n; j++) {
            double a = *sample_entry(s, i - 1, j) - *sample_entry(s, i - 2, j);
            *sample_entry(s, i, j) = a;
            *sample_entry(s, j, i) = -a;
        }
    int laws = dice_below(d, 2) ? LAW_PAIR : LAW_BOX | LAW_PAIR | LAW_EQUALITY;
    for (int i = 0; i < m; i++)
        sample_draw(s, i, i < n ? laws : dice_below(d, 4) ? LAW_EQUALITY : LAW_PAIR, 0.1);
}

static void make_equalities(sample *s, int m) {
    if (dice_below(&s->dice, 2))
        saddle(s, m);
    else {
        box_matrix(s, m);
        sample_draw_all(s, LAW_EQUALITY | LAW_PAIR | (dice_below(&s->dice, 2) ? LAW_FIXED : 0), 0.1);
        s->unique = 0;
    }
    sample_finish(s, SPOIL);
}

static void make_passive(sample *s, int m) {
    if (dice_below(&s->dice, 2))
        generate_whole(s, m);
    else
        generate_reduced(s, m);
}

static void make_mixed(sample *s, int m) {
    box_matrix(s, m);
    if (dice_below(&s->dice, 4) == 0)
        matrix_scale(s, 1);
    sample_draw_all(s, BOUNDS | LAW_EQUALITY, dice_below(&s->dice, 2) ? 0.1 : 0.5);
    sample_finish(s, 0.5);
}

void generate(sample *s, int class, unsigned long long number, int max) {
    static void (*const make[ALL_CLASSES])(sample *, int) = {
        make_p,     make_passive,    make_copositive, make_m,          make_degenerate,
        make_boxes, make_equalities, make_mixed,      infeasible_near, infeasible_any};
    s->dice = dice_make((unsigned)class + 1, number);
    make[class](s, dice_size(&s->dice, 1, max));
}
