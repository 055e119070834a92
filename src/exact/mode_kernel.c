/* src/exact/mode_kernel.c - the matrices of one mode, made from an implicit Euler step. */
#include "sliding.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Whether the command has a guard: one that slides has none. */
static int has_row(const ns_command *c, const ns_mode *mode) {
    return c->gx && !ns_mode_slides(mode[c->pair]);
}

static int control_rows(const ns_system *s, const ns_mode *mode) {
    int count = 0;
    for (int c = 0; c < s->nc; c++)
        count += has_row(&s->command[c], mode);
    return count;
}

/* The guards of pairs: of those that slide, or of the others; behind the last. */
static ns_guard_row *name_pair_rows(const ns_theta *s, const ns_mode *mode, int sliding, ns_guard_row *row) {
    ns_mode to[2];
    for (int j = 0; j < s->s->m; j++)
        for (int i = 0;
             ns_mode_slides(mode[j]) == sliding && i < ns_mode_guards(mode[j], s->l[j], s->u[j], to); i++)
            *row++ = (ns_guard_row){j, to[i], -1};
    return row;
}

static void name_control_rows(const ns_theta *s, const ns_mode *mode, ns_guard_row *row) {
    for (int c = 0; c < s->s->nc; c++) {
        const int j = s->s->command[c].pair;
        if (has_row(&s->s->command[c], mode))
            *row++ = (ns_guard_row){j, mode[j] == NS_INSIDE ? NS_LOWER : NS_INSIDE, c};
    }
}

static ns_mode_kernel *allocate_kernel(const ns_theta *s, const ns_input_states *e, const ns_mode *mode) {
    ns_mode_kernel *k = calloc(1, sizeof *k);
    if (!k)
        return NULL;
    k->r = s->r;
    k->nv = e->nv;
    k->q = s->r + e->nv;
    k->pair_rows = ns_theta_guard_count(s, mode) + 2 * ns_exact_sliding_count(mode, s->s->m);
    k->rows = k->pair_rows + control_rows(s->s, mode);
    const size_t q = (size_t)k->q, r = (size_t)k->r, rows = (size_t)k->rows;
    const size_t all = (size_t)s->s->n + (size_t)s->s->m;
    const size_t count =
        q * (all + (NS_ORDER + 2) * r + (NS_ORDER + 6) * rows) + all * (size_t)e->output_only_inputs;
    k->row = calloc(rows + 1, sizeof *k->row);
    k->always_zero = calloc(rows + 1, 1);
    k->mode = malloc((size_t)s->s->m + 1);
    k->step_x_lambda = malloc((count + 1) * sizeof *k->step_x_lambda); /* fill_kernel() writes all of it */
    if (!k->row || !k->always_zero || !k->mode || !k->step_x_lambda) {
        ns_exact_kernel_free(k);
        return NULL;
    }
    k->laguerre_powers = k->step_x_lambda + all * (q + (size_t)e->output_only_inputs);
    k->guard_powers = k->laguerre_powers + NS_ORDER * r * q;
    k->value = k->guard_powers + NS_ORDER * rows * q;
    k->rate = k->value + rows * q;
    k->second_rate = k->rate + rows * q;
    k->guard_values = k->second_rate + rows * q;
    k->rounding = k->guard_values + 2 * rows * q;
    k->D8 = k->rounding + rows * q;
    k->step = k->D8 + r * q;
    k->bytes = sizeof *k + count * sizeof(double) + rows * sizeof *k->row;
    memcpy(k->mode, mode, (size_t)s->s->m);
    name_control_rows(s, mode, name_pair_rows(s, mode, 1, name_pair_rows(s, mode, 0, k->row)));
    return k;
}

void ns_exact_kernel_free(ns_mode_kernel *kernel) {
    if (!kernel)
        return;
    free(kernel->row);
    free(kernel->always_zero);
    free(kernel->mode);
    ns_exact_output_rows_free(kernel->output_rows);
    free(kernel->step_x_lambda);
    free(kernel->x_lambda_now);
    free(kernel->solved);
    free(kernel->flow_powers);
    free(kernel);
}

void ns_exact_input_matrix(const ns_input_states *e, double h, double *out) {
    const int nv = e->nv;
    for (int j = 0; j < nv; j++) {
        for (int i = 0; i < nv; i++)
            out[i + j * nv] = i == j;
        ns_inputs_states_advance(e, h, out + j * nv);
    }
}

/* Work of a build. */
typedef struct ns_kernel_work {
    int inputs;    /* nz + 1 */
    double *in;    /* inputs*nv: z and 1 at the end of the Euler step, by v */
    double *size;  /* inputs*nv: of absolute values */
    double *dv;    /* nv*nv: (1 - g S)^-1 - 1 */
    double *rates; /* r*(r+inputs): D w by the inputs of the map, */
    double *terms; /* r*(r+inputs): and the size of what they are summed from */
    double *rows;  /* rows*(r+inputs): guards by them, */
    double *noise; /* rows*(r+inputs): and their rounding */
    double *image; /* 2 q */
} ns_kernel_work;

static int allocate_work(const ns_mode_kernel *k, const ns_input_states *e, ns_kernel_work *b) {
    const size_t nv = (size_t)k->nv, inputs = (size_t)e->s->nz + 1, of = (size_t)k->r + inputs;
    b->inputs = (int)inputs;
    const size_t zeros = 2 * inputs * nv + nv * nv;
    b->in =
        malloc((zeros + 2 * ((size_t)k->r + (size_t)k->rows) * of + 2 * (size_t)k->q + 1) * sizeof *b->in);
    if (!b->in)
        return NS_E_MEMORY;
    memset(b->in, 0, zeros * sizeof *b->in);
    b->size = b->in + inputs * nv;
    b->dv = b->size + inputs * nv;
    b->rates = b->dv + nv * nv;
    b->terms = b->rates + (size_t)k->r * of;
    b->rows = b->terms + (size_t)k->r * of;
    b->noise = b->rows + (size_t)k->rows * of;
    b->image = b->noise + (size_t)k->rows * of;
    return NS_OK;
}

/* b->dv, in, size: one implicit Euler step of length g of the inputs, from each unit vector of v. */
static void fill_inputs(const ns_input_states *e, double g, const ns_kernel_work *b) {
    const int nv = e->nv, nz = e->s->nz;
    for (int j = 0; j < nv; j++) {
        double *v = b->dv + j * nv, *in = b->in + j * b->inputs, *size = b->size + j * b->inputs;
        v[j] = 1;
        ns_inputs_states_stage(e, g, v);
        for (int a = 0; a < nv; a++)
            for (int k = 0; k < nz; k++) {
                in[k] += e->Z[k + a * nz] * v[a];
                size[k] += fabs(e->Z[k + a * nz] * v[a]);
            }
        in[nz] = size[nz] = v[0];
        v[j] -= 1;
    }
}

static void fill_pair_rows(const ns_theta *s, const ns_map *map, int rows, const ns_kernel_work *b) {
    for (int k = 0; k < s->q; k++)
        for (int g = 0; g < map->guards; g++) {
            b->rows[g + k * rows] = map->step[(map->guard + g) + k * map->p];
            b->noise[g + k * rows] = map->rounding[g + k * map->guards];
        }
}

/* gx x + gz z + g0 of input k of the map, less its threshold, and the size of the terms. */
static double control_entry(const ns_theta *s, const ns_map *map, const ns_command *c, int closed, int k,
                            double *terms) {
    const int n = s->s->n, m = s->s->m, r = s->r, one = k == s->q - 1;
    const double *x = map->full + (size_t)k * (size_t)(n + m);
    double sum = 0;
    *terms = 0;
    for (int i = 0; i < n; i++) {
        sum += c->gx[i] * x[i];
        *terms += fabs(c->gx[i] * x[i]);
    }
    const double own = one ? c->g0 - (closed ? c->off : c->on) : k >= r && c->gz ? c->gz[k - r] : 0;
    *terms += one ? fabs(c->g0) + fabs(closed ? c->off : c->on) : fabs(own);
    return sum + own;
}

static void fill_control_rows(const ns_theta *s, const ns_map *map, const ns_mode *mode, int first, int rows,
                              const ns_kernel_work *b) {
    for (int c = 0, g = first; c < s->s->nc; c++) {
        const ns_command *of = &s->s->command[c];
        const int closed = map->entry.mode[of->pair] == NS_INSIDE;
        for (int k = 0; has_row(of, mode) && k < s->q; k++) {
            const double sum = control_entry(s, map, of, closed, k, &b->noise[g + k * rows]);
            b->rows[g + k * rows] = closed ? sum : -sum;
        }
        g += has_row(of, mode);
    }
}

/* Column j of p rows given by the inputs of the map; in: b->in or b->size. */
static void to_column(const ns_mode_kernel *k, const ns_kernel_work *b, const double *in, int j, int p,
                      const double *from, double *to) {
    if (p == 0)
        return;
    if (j < k->r) {
        memcpy(to, from + (size_t)j * (size_t)p, sizeof(double) * (size_t)p);
        return;
    }
    ns_linalg_matvec(p, b->inputs, from + (size_t)k->r * (size_t)p, in + (j - k->r) * b->inputs, to);
}

/* Images D^i of unit vector j: their part in w, and the guards of each. */
static void fill_images(ns_mode_kernel *k, const ns_kernel_work *b, const double *D, const double *G, int j) {
    const int r = k->r, nv = k->nv, q = k->q, rows = k->rows;
    const int count = j < r ? r : q; /* of the states that are not zero: w does not move inputs */
    double *x = b->image, *next = x + q;
    memset(x, 0, sizeof(double) * (size_t)q);
    x[j] = 1;
    for (int i = 0; i <= NS_ORDER; i++) {
        if (i > 0)
            memcpy(k->laguerre_powers + (i - 1) * r + (size_t)j * (size_t)(NS_ORDER * r), x,
                   sizeof(double) * (size_t)r);
        if (i == NS_ORDER)
            memcpy(k->D8 + (size_t)j * (size_t)r, x, sizeof(double) * (size_t)r);
        if (i < NS_ORDER) {
            ns_linalg_matvec(rows, count, G, x,
                             k->guard_powers + i * rows + (size_t)j * (size_t)(NS_ORDER * rows));
            ns_linalg_matvec(r, count, D, x, next);
            if (j >= r)
                ns_linalg_matvec(nv, nv, b->dv, x + r, next + r);
        }
        double *swap = x;
        x = next;
        next = swap;
    }
}

/* (E1) at tau = 0 */
static void fill_guards_now(ns_mode_kernel *k) {
    for (int j = 0; j < k->q; j++)
        for (int g = 0; g < k->rows; g++) {
            const double *c = k->guard_powers + g + (size_t)j * (size_t)(NS_ORDER * k->rows);
            double value = 0, rate = 0, second_rate = 0;
            for (int i = NS_ORDER - 1; i >= 0; i--) {
                const double term = i % 2 ? -c[i * k->rows] : c[i * k->rows];
                value += term;
                rate -= i * term;
                second_rate += 0.5 * i * (i - 1) * term;
            }
            k->guard_values[g + 2 * j * k->rows] = k->value[j + g * k->q] = value;
            k->guard_values[g + (2 * j + 1) * k->rows] = k->rate[j + g * k->q] = rate / k->g;
            k->second_rate[j + g * k->q] = second_rate / (k->g * k->g);
        }
}

/* own (rows*q): the rounding of the guards themselves.  That of the charges, from the terms they are summed
 * from, is added. */
static void fill_rounding(ns_mode_kernel *k, const double *own, const double *terms) {
    for (int g = 0; g < k->rows; g++)
        for (int j = 0; j < k->q; j++) {
            double sum = own[g + j * k->rows];
            for (int i = 0; i < k->r; i++)
                sum += fabs(k->value[i + g * k->q]) * terms[i + j * k->r];
            k->rounding[g + j * k->rows] = sum;
        }
}

/* 1 if value, rate and second rate are rounding for every input. */
static int is_always_zero(const ns_mode_kernel *k, int g) {
    const double few = 64 * DBL_EPSILON;
    for (int j = 0; j < k->q; j++) {
        const int at = j + g * k->q;
        const double size = fabs(k->value[at]) + k->g * (fabs(k->rate[at]) + k->g * fabs(k->second_rate[at]));
        if (size > few * k->rounding[g + j * k->rows])
            return 0;
    }
    return 1;
}

static int fill_kernel(ns_theta *s, const ns_input_states *e, const ns_map *map, const ns_mode *mode,
                       ns_mode_kernel *k) {
    const size_t q = (size_t)k->q, all = (size_t)s->s->n + (size_t)s->s->m;
    ns_kernel_work b;
    double *G = malloc((2 * ((size_t)k->rows + (size_t)k->r) * q + 1) * sizeof *G);
    if (!G || allocate_work(k, e, &b) != NS_OK) {
        free(G);
        return NS_E_MEMORY;
    }
    double *D = G + (size_t)k->rows * q, *terms = D + (size_t)k->r * q, *noise = terms + (size_t)k->r * q;
    fill_inputs(e, k->g, &b);
    ns_exact_kernel_charge_rates(s, map, b.rates, b.terms);
    fill_pair_rows(s, map, k->rows, &b);
    ns_exact_sliding_fill(s, map, mode, k->rows, b.rows + map->guards, b.noise + map->guards);
    fill_control_rows(s, map, mode, k->pair_rows, k->rows, &b);
    for (int j = 0; j < k->q; j++) {
        to_column(k, &b, b.in, j, (int)all, map->full, k->step_x_lambda + (size_t)j * all);
        to_column(k, &b, b.in, j, k->r, b.rates, D + (size_t)j * (size_t)k->r);
        to_column(k, &b, b.size, j, k->r, b.terms, terms + (size_t)j * (size_t)k->r);
        to_column(k, &b, b.in, j, k->rows, b.rows, G + (size_t)j * (size_t)k->rows);
        to_column(k, &b, b.size, j, k->rows, b.noise, noise + (size_t)j * (size_t)k->rows);
    }
    for (int i = 0; i < e->output_only_inputs; i++)
        memcpy(k->step_x_lambda + (q + (size_t)i) * all,
               map->full + (size_t)(k->r + e->output_only_input[i]) * all, sizeof *k->step_x_lambda * all);
    for (int j = 0; j < k->q; j++)
        fill_images(k, &b, D, G, j);
    fill_guards_now(k);
    fill_rounding(k, noise, terms);
    ns_exact_kernel_add_left_off(s, k, b.image);
    for (int g = 0; g < k->rows; g++)
        k->always_zero[g] = (unsigned char)is_always_zero(k, g);
    ns_exact_kernel_step(k, k->h, k->step);
    free(b.in);
    free(G);
    return NS_OK;
}

int ns_exact_kernel_build(ns_theta *s, const ns_input_states *e, double g, const ns_mode *mode,
                          ns_mode_kernel **out) {
    ns_map *map;
    *out = NULL;
    int status = ns_exact_sliding_map(s, g, mode, &map);
    if (status != NS_OK)
        return status;
    ns_mode_kernel *k = allocate_kernel(s, e, mode);
    status = NS_E_MEMORY;
    if (k) {
        k->g = g;
        k->h = g * NS_POLE;
        status = fill_kernel(s, e, map, mode, k);
    }
    ns_theta_map_free(map);
    if (status != NS_OK) {
        ns_exact_kernel_free(k);
        return status;
    }
    *out = k;
    return NS_OK;
}

void ns_exact_kernel_step(const ns_mode_kernel *k, double tau, double *P) {
    double b[NS_ORDER + 1];
    ns_modes_laguerre_steps(tau / k->g, b);
    for (int j = 0; j < k->q; j++)
        for (int i = 0; i < k->r; i++) {
            const double *D = k->laguerre_powers + i + (size_t)j * (size_t)(NS_ORDER * k->r);
            double sum = 0;
            for (int order = NS_ORDER; order > 0; order--)
                sum += b[order] * D[(order - 1) * k->r];
            P[i + j * k->r] = sum + (i == j); /* (E2) */
        }
}

void ns_exact_kernel_compose(const ns_mode_kernel *k, const double *P2, const double *P1,
                             const double *advance, double *P) {
    const int r = k->r, nv = k->nv;
    const double *by_v = P2 + (size_t)r * (size_t)r;
    for (int j = 0; j < k->q; j++)
        ns_linalg_matvec(r, r, P2, P1 + (size_t)j * (size_t)r, P + (size_t)j * (size_t)r);
    for (int j = 0; j < nv; j++)
        ns_linalg_matvec_add(r, nv, by_v, advance + (size_t)j * (size_t)nv, P + (size_t)(r + j) * (size_t)r);
}

int ns_exact_kernel_rates(const ns_mode_kernel *k, double *re, double *im) {
    const int r = k->r;
    double *D = malloc(sizeof *D * ((size_t)r * (size_t)r + 1));
    if (!D)
        return NS_E_MEMORY;
    for (int j = 0; j < r; j++)
        memcpy(D + (size_t)j * (size_t)r, k->laguerre_powers + (size_t)j * (size_t)(NS_ORDER * r),
               sizeof *D * (size_t)r);
    const int status = ns_linalg_eigenvalues(r, D, re, im);
    free(D);
    for (int i = 0; i < r && status == NS_OK; i++) {
        const double a = 1 + re[i], b = im[i], size = a * a + b * b;
        if (size < 1e-15) { /* instantaneous: its rounding would give it any rate, of any sign */
            re[i] = -INFINITY;
            im[i] = size > 1e-26; /* more than rounding */
            continue;
        }
        const double x = re[i];
        re[i] = (x * a + b * b) / size / k->g; /* d / (1 + d) */
        im[i] = b / size / k->g;
    }
    return status;
}

double ns_exact_kernel_length(double h, double rate) {
    const double longest = 256 * h;
    if (!(rate > 0) || NS_REACH / rate >= longest)
        return longest;
    return ldexp(h, (int)floor(log2(NS_REACH / rate / h)));
}
