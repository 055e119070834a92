/* src/engine/sparse_guard.c - guards of a mode: after an Euler step, and over a leg.
 *
 * Over a leg a guard is a polynomial (E1).  A bound by its coefficients tells that most hold; the others are
 * put into Bernstein's form, whose coefficients bound it, and halved until they tell.
 */
#include "sparse_march.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* What a guard may be below zero by, relative to the terms it is summed from, and of a control. */
static const double rounding = 64 * DBL_EPSILON, control_rounding = 1e-12;

void ns_guard_bounds(ns_sparse *m) {
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair, closed = m->mode[j] == NS_INSIDE;
        m->l[j] = closed ? -INFINITY : 0;
        m->u[j] = closed ? INFINITY : 0;
    }
}

void ns_guard_set(ns_sparse *m, int j, int upper) {
    if (ns_slides(m->mode[j]))
        m->mode[j] = upper ? NS_INSIDE : NS_LOWER; /* y is used up, or lambda */
    else if (m->mode[j] == NS_INSIDE)
        m->mode[j] = upper ? NS_UPPER : NS_LOWER;
    else
        m->mode[j] = NS_INSIDE;
}

/* The rounding of y_j at v. */
static double noise_of_y(const ns_sparse *m, int j, const double *v) {
    return rounding * (ns_csc_size(&m->f->Ct, j, v) + fabs(m->f->e[j])) + DBL_EPSILON * m->most_y;
}

/* The rounding of guards of pair j at v = (x, lambda), which was solved for with w and g: of the sum y, or of
 * lambda as what is left over in the rows it enters; where all of these are zero, beside the largest there
 * was. */
static double noise(const ns_sparse *m, int j, const double *v, const double *w, double g) {
    const ns_form *f = m->f;
    double most = 0;
    if (m->mode[j] != NS_INSIDE && !ns_slides(m->mode[j]))
        return noise_of_y(m, j, v);
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i >= f->n || f->KA[k] == 0)
            continue;
        double terms = ns_csc_size(&f->At, i, v) + fabs(f->b[i]);
        if (!f->algebraic[i])
            terms += (ns_csc_size(&f->Mt, i, v) + fabs(w[i])) / g;
        most = fmax(most, terms / fabs(f->KA[k]));
    }
    return rounding * most + DBL_EPSILON * m->most_lambda + (ns_slides(m->mode[j]) ? noise_of_y(m, j, v) : 0);
}

/* Guards of pair j: how many, and number k of them at (lambda_j, y_j), what is constant in it counted so many
 * times. */
static int guards_of(const ns_sparse *m, int j) {
    if (ns_slides(m->mode[j]))
        return 2;
    return m->mode[j] == NS_INSIDE ? isfinite(m->l[j]) + isfinite(m->u[j]) : m->l[j] < m->u[j];
}

static int is_upper(const ns_sparse *m, int j, int k) {
    return k == 1 || !isfinite(m->l[j]);
}

static double guard(const ns_sparse *m, int j, int k, const double *v, const double *z, int constants) {
    const double lambda = v[m->f->n + j];
    if (m->mode[j] != NS_INSIDE) {
        const double y = ns_form_y(m->f, j, v, z, constants);
        if (ns_slides(m->mode[j]))
            return (m->mode[j] == NS_SLIDES_UP ? 1 : -1) * (k == 1 ? -y : lambda);
        return m->mode[j] == NS_LOWER ? y : -y;
    }
    return is_upper(m, j, k) ? (constants ? m->u[j] : 0) - lambda : lambda - (constants ? m->l[j] : 0);
}

/* What v may be off by where w is off by its rounding, at random: to m->next_v. */
static int shake(ns_sparse *m, const double *v, const double *w, double g) {
    const ns_form *f = m->f;
    const ns_kept *k;
    unsigned long long dice = 88172645463325252U;
    const int status = ns_modal_factor(m->q, g, m->mode, 1, &k);
    if (status != NS_OK)
        return status;
    memset(m->r, 0, sizeof(double) * (size_t)f->size);
    for (int i = 0; i < f->n; i++) {
        dice ^= dice << 13;
        dice ^= dice >> 7;
        dice ^= dice << 17;
        const double of =
            f->algebraic[i] ? ns_csc_size(&f->At, i, v) : fabs(w[i]) + ns_csc_size(&f->Mt, i, v);
        m->r[i] = (dice & 1024 ? 4 : -4) * DBL_EPSILON * of;
    }
    (void)ns_modal_solve(m->q, k, m->r, m->next_v);
    return NS_OK;
}

/* 1 if pair j keeps its law at v, to the last bit. */
static inline int holds(const ns_sparse *m, int j, const double *v) {
    if (m->mode[j] == NS_INSIDE)
        return v[m->f->n + j] >= m->l[j] && v[m->f->n + j] <= m->u[j];
    if (!(m->l[j] < m->u[j]))
        return !ns_slides(m->mode[j]);
    const double y = ns_form_y(m->f, j, v, m->z, 1);
    return m->mode[j] == NS_LOWER ? y >= 0 : y <= 0;
}

/* Guards at v that are negative by more than the sum of their terms explains; marks them in m->flip. */
static int find_broken(ns_sparse *m, const double *v, const double *w, double g) {
    int count = 0;
    memset(m->flip, 0, (size_t)m->f->m);
    for (int j = 0; j < m->f->m; j++) {
        const int guards = holds(m, j, v) ? 0 : guards_of(m, j);
        for (int k = 0; k < guards; k++) {
            const double value = guard(m, j, k, v, m->z, 1);
            if (!(value < 0) || value >= -noise(m, j, v, w, g))
                continue;
            m->flip[j] = (unsigned char)(1 + is_upper(m, j, k));
            count++;
            break;
        }
    }
    return count;
}

int ns_guard_broken(ns_sparse *m, const double *v, const double *w, double g) {
    int count = 0;
    if (find_broken(m, v, w, g) == 0 || shake(m, v, w, g) != NS_OK)
        return 0;
    memset(m->z_none, 0, sizeof(double) * (size_t)m->f->nz);
    for (int j = 0; j < m->f->m; j++) {
        const int k = m->flip[j] == 2 && guards_of(m, j) == 2;
        if (!m->flip[j])
            continue;
        const double by = fabs(guard(m, j, k, m->next_v, m->z_none, 0));
        if (guard(m, j, k, v, m->z, 1) >= -(noise(m, j, v, w, g) + 16 * by))
            m->flip[j] = 0;
        count += m->flip[j] != 0;
    }
    return count;
}

int ns_guard_flip(ns_sparse *m, const double *v, const double *w, double g) {
    const int count = ns_guard_broken(m, v, w, g);
    for (int j = 0; j < m->f->m && count > 0; j++)
        if (m->flip[j]) {
            ns_guard_set(m, j, m->flip[j] == 2);
            m->touched[j] = 1;
        }
    return count;
}

/* --- commands of the state --- */

/* 1 if command c looks at the state, and may change by it. */
static int of_state(const ns_sparse *m, int c) {
    return !ns_slides(m->mode[m->s->command[c].pair]) && m->f->gx.start[c + 1] > m->f->gx.start[c];
}

/* By how much control c stays on its side of the threshold that would change it. */
static double margin(const ns_sparse *m, int c, const double *v, const double *z, int constants) {
    const ns_command *k = &m->s->command[c];
    const int closed = m->mode[k->pair] == NS_INSIDE;
    const double g = ns_csc_dot(&m->f->gx, c, v) + ns_csc_dot(&m->f->gz, c, z);
    if (!constants)
        return closed ? g : -g;
    return closed ? (g + k->g0) - k->off : k->on - (g + k->g0);
}

static double control_noise(const ns_sparse *m, int c, const double *v, const double *z) {
    return control_rounding *
           (ns_csc_size(&m->f->gx, c, v) + ns_csc_size(&m->f->gz, c, z) + fabs(m->s->command[c].g0));
}

/* Where a switch wants back what it has just left it stays between, beside what conducts while it is closed;
 * 0: it cannot. */
static int let_slide(ns_sparse *m, int c, const double *v, const ns_leg *leg) {
    const int j = m->s->command[c].pair, closed = m->mode[j] == NS_INSIDE;
    if (m->f->command[j] != c || (!closed && !(leg && leg->mode[j] == NS_INSIDE)))
        return 0;
    const double side = closed ? v[m->f->n + j] : -ns_form_y(m->f, j, v, m->z, 1);
    if (!(side < 0 || side > 0))
        return 0;
    for (int i = 0; i < m->f->m && !closed; i++)
        if (m->l[i] < m->u[i] && (isfinite(m->l[i]) || isfinite(m->u[i]))) /* not a switch */
            m->mode[i] = leg->mode[i];
    m->mode[j] = side > 0 ? NS_SLIDES_UP : NS_SLIDES_DOWN;
    return 1;
}

int ns_guard_commands(ns_sparse *m, const double *v, const ns_leg *leg, unsigned char *changed) {
    int count = 0;
    for (int c = 0; c < m->s->nc; c++) {
        const int j = m->s->command[c].pair;
        if (!of_state(m, c) || margin(m, c, v, m->z, 1) >= -control_noise(m, c, v, m->z))
            continue;
        const int slides = changed && changed[c] && let_slide(m, c, v, leg);
        if (!slides)
            m->mode[j] = m->mode[j] == NS_INSIDE ? NS_LOWER : NS_INSIDE;
        if (changed)
            changed[c] = (unsigned char)(1 + slides);
        count++;
    }
    if (count > 0)
        ns_guard_bounds(m);
    return count;
}

/* --- over a leg --- */

typedef struct search {
    int terms;
    double to_bernstein[NS_STAGES][NS_STAGES]; /* [j][i]: of (-1)^i L_i, to Bernstein's j, on [0, end] */
    double tol;
    int splits; /* left */
} search;

static double choose(int n, int k) {
    double c = 1;
    for (int i = 0; i < k; i++)
        c = c * (n - i) / (i + 1);
    return c;
}

static void set_search(search *s, int terms, double end) {
    s->terms = terms;
    for (int i = 0; i < terms; i++)
        for (int j = 0; j < terms; j++) {
            double sum = 0, power = 1; /* L_i(end u) = sum_k C(i,k) (-end u)^k / k! */
            for (int k = 0; k <= i && k <= j; k++) {
                sum += choose(i, k) * power * choose(j, k) / choose(terms - 1, k);
                power *= -end / (k + 1);
            }
            s->to_bernstein[j][i] = i % 2 ? -sum : sum;
        }
}

/* The first u in [low, high] with value below -tol, NAN if there is none. */
static double first_below(search *s, const double *b, double low, double high, int depth) {
    double left[NS_STAGES], right[NS_STAGES], least = INFINITY;
    const int terms = s->terms;
    for (int i = 0; i < terms; i++)
        least = fmin(least, b[i]);
    if (least >= -s->tol)
        return NAN;
    if (b[0] < -s->tol || depth >= 52 || s->splits-- <= 0)
        return low;
    memcpy(right, b, sizeof right);
    for (int i = 0; i < terms; i++) { /* de Casteljau, at the middle */
        left[i] = right[0];
        for (int k = 0; k + 1 < terms - i; k++)
            right[k] = 0.5 * (right[k] + right[k + 1]);
    }
    /* right[terms-1-i] is the last of round i: already in place */
    const double mid = 0.5 * (low + high), first = first_below(s, left, low, mid, depth + 1);
    return isnan(first) ? first_below(s, right, mid, high, depth + 1) : first;
}

/* Where in [0, 1] guard G falls below -tol. */
static double crossing(search *s, const double *G, double tol) {
    double b[NS_STAGES] = {0};
    for (int j = 0; j < s->terms; j++)
        for (int i = 0; i < s->terms; i++)
            b[j] += s->to_bernstein[j][i] * G[i];
    s->tol = tol;
    s->splits = 4000;
    return first_below(s, b, 0, 1, 0);
}

static int surely_holds(const ns_sparse *m, const double *G) {
    double least = G[0];
    for (int i = 1; i < NS_ORDER; i++)
        least -= m->largest[i] * fabs(G[i]);
    return least > 0;
}

static void coefficients(const ns_sparse *m, const ns_leg *leg, int terms, int pair, int k, int command,
                         double *G) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    for (int i = 0; i < terms; i++) {
        const double *v = leg->xi + (size_t)i * size, *z = leg->z + (size_t)i * nz;
        G[i] = pair >= 0 ? guard(m, pair, k, v, z, i == 0) : margin(m, command, v, z, i == 0);
    }
}

typedef struct found {
    double at; /* share of the leg */
    int pair, k, command;
} found;

/* The next coefficient, guessed from the last two: what a guard is off by at the start of a leg. */
static double cut_off(const double *G, int terms) {
    const double last = fabs(G[terms - 1]), before = fabs(G[terms - 2]);
    return last < before ? 2 * last * (last / before) : last;
}

/* Where in the leg one guard breaks, by the coefficients there are. */
static double breaks(const ns_sparse *m, const ns_leg *leg, search *s, const found *f, double *G) {
    coefficients(m, leg, s->terms, f->pair, f->k, f->command, G);
    if (s->terms == NS_ORDER && surely_holds(m, G))
        return NAN;
    const double tol = f->pair >= 0 ? noise(m, f->pair, leg->xi, leg->dw, leg->g)
                                    : control_noise(m, f->command, leg->xi, leg->z);
    const double size = f->pair < 0 ? 0 : m->mode[f->pair] == NS_INSIDE ? m->most_lambda : m->most_y;
    return crossing(s, G, tol + cut_off(G, s->terms) + m->o.reltol * size);
}

/* The value of a guard of NS_STAGES coefficients. */
static double value_at(const double *G, double s) {
    double c[NS_STAGES], b[NS_ORDER + 1], sum = 0;
    ns_laguerre(s, c);
    ns_laguerre_steps(s, b);
    c[NS_ORDER] = b[NS_ORDER] - c[NS_ORDER - 1];
    for (int i = NS_ORDER; i >= 0; i--)
        sum += c[i] * G[i];
    return sum;
}

/* Where it crosses zero near share `at` of the leg, of which s is the end. */
static double root_near(const double *G, double at, double s) {
    double low = at, high = at, step = 1e-9;
    if (value_at(G, at * s) < 0)
        for (; low > 0 && value_at(G, low * s) < 0; step *= 4)
            low = fmax(0, low - step);
    else
        for (; high < 1 && value_at(G, high * s) >= 0; step *= 4)
            high = fmin(1, high + step);
    if (value_at(G, low * s) < 0 || value_at(G, high * s) >= 0)
        return low <= 0 ? 0 : INFINITY; /* after the leg */
    for (int i = 0; i < 80; i++) {
        const double mid = low + (high - low) / 2;
        if (!(mid > low && mid < high))
            break;
        *(value_at(G, mid * s) < 0 ? &high : &low) = mid;
    }
    return low;
}

/* Looks for one guard's crossing before the first found so far: roughly, then with the last stage, as exact
 * as the step. */
static int look(ns_sparse *m, ns_leg *leg, search *s, found next, found *f) {
    double G[NS_STAGES] = {0};
    if (!(breaks(m, leg, &s[0], &next, G) < f->at))
        return NS_OK;
    const int status = ns_leg_last_stage(m, leg);
    if (status != NS_OK)
        return status;
    next.at = breaks(m, leg, &s[1], &next, G);
    if (next.at > 0)
        next.at = root_near(G, next.at, leg->end / leg->g);
    if (next.at < f->at)
        *f = next;
    return NS_OK;
}

static void take_sizes(ns_sparse *m, const double *v) {
    for (int j = 0; j < m->f->m; j++) {
        m->most_lambda = fmax(m->most_lambda, fabs(v[m->f->n + j]));
        m->most_y = fmax(m->most_y, fabs(ns_csc_dot(&m->f->Ct, j, v)));
    }
}

int ns_guard_first(ns_sparse *m, ns_leg *leg) {
    search s[2];
    found f = {INFINITY, -1, 0, -1};
    int status = NS_OK;
    set_search(&s[0], NS_ORDER, leg->end / leg->g);
    set_search(&s[1], NS_STAGES, leg->end / leg->g);
    take_sizes(m, leg->xi);
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        for (int k = 0; k < guards && status == NS_OK; k++)
            status = look(m, leg, s, (found){NAN, j, k, -1}, &f);
    }
    for (int c = 0; c < m->s->nc && status == NS_OK; c++)
        if (of_state(m, c))
            status = look(m, leg, s, (found){NAN, -1, 0, c}, &f);
    if (status != NS_OK || !(f.at <= 1))
        return status;
    leg->why = NS_LEG_EVENT;
    leg->pair = f.pair;
    leg->command = f.command;
    leg->upper = f.pair >= 0 && is_upper(m, f.pair, f.k);
    if (f.at < 1) {
        leg->end *= f.at;
        leg->end_t = leg->t + leg->end;
    }
    return status;
}
