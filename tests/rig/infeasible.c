/* tests/rig/infeasible.c - random problems without a solution, each made from a proof of that.
 *
 * For any v a solution satisfies   0 = sum_i v_i (y_i - q_i) - sum_j t_j lambda_j,   t = W' v.   Drawn are v,
 * 0 where y may have any sign, else of the sign that y_i must have, and t, 0 where lambda_j is free, else
 * such that -t_j lambda_j is bounded below; row k of W and q_k are what makes W' v = t and the whole of the
 * right side at least `margin` > 0. All numbers are short, so that nothing is rounded.
 */
#include "infeasible.h"

#include <math.h>

#include "generators.h"
#include "matrices.h"

enum { ANY = LAW_PAIR | LAW_SHIFTED | LAW_REVERSED | LAW_BOX | LAW_RELAY | LAW_FIXED | LAW_EQUALITY };

static double sign_of_y(const sample *s, int i) { /* 0: any; 2: none */
    return isinf(s->l[i]) && isinf(s->u[i]) ? 2 : isinf(s->u[i]) ? 1 : isinf(s->l[i]) ? -1 : 0;
}

/* v_i for at least one i in [from, to); returns the one that is +-1. */
static int draw_proof(sample *s, int from, int to) {
    dice *d = &s->dice;
    int most = 1 + dice_below(d, 6), k = from + dice_below(d, to - from);
    if (sign_of_y(s, k) == 0) {
        s->l[k] = 0;
        s->u[k] = INFINITY;
    }
    for (int n = 0; n < most; n++) {
        int i = n ? from + dice_below(d, to - from) : k;
        double sign = sign_of_y(s, i);
        if (sign == 2)
            sign = dice_below(d, 2) ? 1 : -1;
        if (n == 0 || i != k)
            s->farkas[i] = sign * (n ? 1 + dice_below(d, 3) : 1);
    }
    return k;
}

/* (W' v)_j such that -t_j lambda_j has a least value, which is added to *least. */
static double draw_slope(sample *s, int j, double *least) {
    double t = dice_below(&s->dice, 3) ? 0 : (1 + dice_below(&s->dice, 16)) / 8.0;
    t *= isinf(s->u[j]) || (isfinite(s->l[j]) && dice_below(&s->dice, 2)) ? -1 : 1;
    if (isinf(s->l[j]) && isinf(s->u[j]))
        t = 0;
    if (t != 0)
        *least += t < 0 ? -t * s->l[j] : -t * s->u[j];
    return t;
}

/* sum over the rows but k of v_i W_ij */
static double others(const sample *s, int j, int k) {
    double sum = 0;
    for (int i = 0; i < s->m; i++)
        if (i != k && s->farkas[i] != 0)
            sum += s->farkas[i] * s->W[i + j * s->m];
    return sum;
}

static void set_last(sample *s, int k, double least, double margin) {
    double sum = 0;
    for (int i = 0; i < s->m; i++) {
        s->q[i] = dice_eighths(&s->dice, 2);
        sum += i != k ? s->farkas[i] * s->q[i] : 0;
        s->lambda[i] = s->y[i] = 0;
    }
    s->q[k] = s->farkas[k] * (least - margin - sum);
}

static double margin(sample *s) {
    return (1 + dice_below(&s->dice, 16)) / (dice_below(&s->dice, 2) ? 8.0 : 512.0);
}

/* Any matrix, also one of several parts, any laws. */
static void rows(sample *s, int m) {
    dice *d = &s->dice;
    int parts = dice_below(d, 3) ? 1 : 1 + dice_below(d, 5);
    double density = dice_uniform(d), least = 0;
    sample_start(s, m);
    s->kind = parts > 1 ? "constraints, in parts" : "constraints";
    s->exact = 1;
    sample_draw_all(s, dice_below(d, 2) ? ANY : LAW_PAIR | LAW_EQUALITY, 0);
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++)
            *sample_entry(s, i, j) = i % parts == j % parts && dice_chance(d, density) ? sample_value(s) : 0;
    int k = draw_proof(s, 0, m);
    for (int j = 0; j < m; j++) {
        double t = s->farkas[k] != 0 && j % parts == k % parts ? draw_slope(s, j, &least) : 0;
        *sample_entry(s, k, j) = s->farkas[k] * (t - others(s, j, k));
    }
    set_last(s, k, least, margin(s));
}

/* [Q -A'; A 0], the constraints A x >= b contradict: copositive-plus, all of them pairs or equalities. */
static void program(sample *s, int m) {
    int n = 1 + dice_below(&s->dice, m - 1), copositive = dice_below(&s->dice, 2);
    double least = 0;
    sample_start(s, m);
    s->kind = copositive ? "copositive program without a point" : "program without a point";
    s->exact = 1;
    sample_draw_all(s, LAW_PAIR, 0);
    matrix_program(s, n, copositive);
    int k = draw_proof(s, n, m);
    for (int j = 0; j < n; j++) {
        double w = draw_slope(s, j, &least) - others(s, j, k);
        *sample_entry(s, k, j) = w;
        *sample_entry(s, j, k) = -w;
    }
    set_last(s, k, least, margin(s));
}

/* V V' + S, S skew, V'v = 0 and S'v <= 0: its v is a ray. */
static int monotone(sample *s, int m) {
    double unused = 0;
    int rank = dice_below(&s->dice, m + 1);
    sample_start(s, m);
    s->exact = 1;
    sample_draw_all(s, LAW_PAIR, 0);
    int k = draw_proof(s, 0, m);
    for (int c = 0; c < rank; c++) {
        double sum = 0, *v = s->work2 + c * m;
        for (int i = 0; i < m; i++)
            sum += i != k ? s->farkas[i] * (v[i] = dice_integer(&s->dice, 1)) : 0;
        v[k] = -sum;
        for (int j = 0; j < m; j++)
            for (int i = 0; i < m; i++)
                *sample_entry(s, i, j) += v[i] * v[j];
    }
    matrix_add_skew(s);
    for (int j = 0; j < m; j++) /* V'v = 0 leaves the skew part alone */
        if (j != k) {
            double w = (s->farkas[j] != 0 ? 0 : draw_slope(s, j, &unused)) - others(s, j, k);
            *sample_entry(s, j, k) -= w - *sample_entry(s, k, j);
            *sample_entry(s, k, j) = w;
        }
    return k;
}

/* Two rows of a network, or a row and a sum, one the other turned round: A x >= b and -A x >= c, b + c > 0.
 */
static int network(sample *s, int m) {
    generate_whole(s, m);
    int i = dice_below(&s->dice, s->m), k = dice_below(&s->dice, s->m);
    double a = (1 + dice_below(&s->dice, 8)) / 8.0, b = (1 + dice_below(&s->dice, 8)) / 8.0;
    double turn = s->row[k] / s->row[i];
    if (i == k || fabs(sign_of_y(s, i)) < 1 || fabs(sign_of_y(s, k)) < 1)
        return 0;
    s->kind = "network";
    for (int j = 0; j < s->m; j++)
        *sample_entry(s, k, j) = -turn * *sample_entry(s, i, j);
    s->farkas[i] = 1 / s->row[i];
    s->farkas[k] = 1 / s->row[k];
    s->q[i] = -a * s->row[i];
    s->q[k] = -b * s->row[k];
    return 1;
}

static void units(sample *s) {
    s->none = 1;
    if (dice_below(&s->dice, 3) == 0)
        sample_units(s, 1 + dice_below(&s->dice, 50));
}

void infeasible_any(sample *s, int m) {
    int kind = dice_below(&s->dice, 4);
    if (kind == 3 && network(s, m)) {
        s->none = 1;
        return;
    }
    if (kind == 1 && m > 1)
        program(s, m);
    else if (kind == 2) {
        set_last(s, monotone(s, m), 0, margin(s));
        s->kind = "monotone, a ray";
    } else
        rows(s, m);
    units(s);
}

void infeasible_near(sample *s, int m) {
    int none = dice_below(&s->dice, 2), k = monotone(s, m);
    double by = ldexp(1, -dice_below(&s->dice, 18));
    s->kind = none ? "monotone, just infeasible" : "monotone, just feasible";
    if (none) {
        set_last(s, k, 0, by);
        units(s);
        return;
    }
    for (int j = 0; j < m; j++) { /* 0 = sum v_i (y_i - q_i) - sum t_j lambda_j with as little room as that */
        double t = others(s, j, -1), v = s->farkas[j];
        if (v != 0)
            s->y[j] = 0;
        else if (t != 0) {
            s->lambda[j] = 0;
            s->y[j] = dice_eighths(&s->dice, 1) + 1;
        }
    }
    s->y[k] = dice_below(&s->dice, 2) ? by : 0;
    s->lambda[k] = s->y[k] > 0 ? 0 : s->lambda[k];
    for (int i = 0; i < m; i++)
        s->farkas[i] = 0;
    sample_finish(s, 0.3);
}
