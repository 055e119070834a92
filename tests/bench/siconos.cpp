/* tests/bench/siconos.cpp - one run of a case by Siconos (its kernel's time stepping: Euler-Moreau, an LCP a step).
 *
 *     siconos CASE SOLVER THETA H      CASE: lc_bridge or literature; SOLVER: a number of lcp_cst.h; H in s
 *
 * Runs the same hand-written system that the library takes, from the same start, and prints `done`, the s of CPU of
 * the creation, those of the run, its steps, and the values that are compared, time by time.  Inputs are put into
 * b and e before each step, as constants; matrices and what is factored of them stay. */
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <SiconosKernel.hpp>
#include <lcp_cst.h>

extern "C" {
#include "timing.h"

#include "cases.h"
#include "systems.h"
}

typedef std::shared_ptr<SimpleMatrix> matrix;
typedef std::shared_ptr<SiconosVector> column;

static matrix matrix_of(int rows, int columns, const double *a, const double *mass) {
    matrix m(new SimpleMatrix((unsigned)rows, (unsigned)columns));
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++)
            m->setValue((unsigned)i, (unsigned)j, a ? a[i + j * rows] / (mass ? mass[i * (rows + 1)] : 1) : 0);
    return m;
}

static void put_inputs(const ns_system *s, double t, const column &b, const column &e) {
    double z[16];
    ns_system_inputs(s, t, NS_LEFT, z);
    for (int i = 0; i < s->n; i++) {
        double sum = s->b ? s->b[i] : 0;
        for (int k = 0; k < s->nz; k++)
            sum += s->E[i + k * s->n] * z[k];
        b->setValue((unsigned)i, sum / s->M[i * (s->n + 1)]);
    }
    for (int i = 0; i < s->m; i++) {
        double sum = s->e ? s->e[i] : 0;
        for (int k = 0; k < s->nz; k++)
            sum += s->F[i + k * s->m] * z[k];
        e->setValue((unsigned)i, sum);
    }
}

static void run(const bench_case *c, const ns_system *s, const double *x0, int solver, double theta, double h) {
    const double start = now();
    column x(new SiconosVector((unsigned)s->n)), b(new SiconosVector((unsigned)s->n)), e(new SiconosVector((unsigned)s->m));
    for (int i = 0; i < s->n; i++)
        x->setValue((unsigned)i, x0[i]);
    put_inputs(s, 0, b, e);
    SP::FirstOrderLinearTIDS ds(new FirstOrderLinearTIDS(x, matrix_of(s->n, s->n, s->A, s->M), b));
    matrix none;
    SP::FirstOrderLinearTIR relation(new FirstOrderLinearTIR(
        matrix_of(s->m, s->n, s->C, NULL), matrix_of(s->m, s->m, s->D, NULL), none, e, matrix_of(s->n, s->m, s->B, s->M)));
    SP::NonSmoothLaw law(new ComplementarityConditionNSL((unsigned)s->m));
    SP::Interaction interaction(new Interaction(law, relation));
    SP::NonSmoothDynamicalSystem all(new NonSmoothDynamicalSystem(0, c->end * 2));
    all->insertDynamicalSystem(ds);
    all->link(interaction, ds);
    SP::TimeDiscretisation td(new TimeDiscretisation(0, h));
    SP::EulerMoreauOSI osi(new EulerMoreauOSI(theta));
    SP::LCP lcp(new LCP(solver));
    SP::TimeStepping stepping(new TimeStepping(all, td, osi, lcp));
    stepping->initialize();
    const double created = now() - start;
    double values[CASE_VALUES];
    long steps = 0;
    for (int k = 0; k < c->times; k++) {
        for (const long until = (long)(c->time[k] / h + 0.5); steps < until; steps++) {
            if (s->nz > 0)
                put_inputs(s, h * (double)(steps + 1), ds->b(), relation->e());
            stepping->computeOneStep();
            stepping->nextStep();
        }
        for (int i = 0; i < c->unknowns; i++)
            values[k * c->unknowns + i] = ds->x()->getValue((unsigned)(c->system ? c->unknown[i].of : i));
        if (!c->system && values[k * c->unknowns] < 0) /* of the bridge the rectified voltage is compared */
            values[k * c->unknowns] *= -1;
    }
    std::printf("done %.9g %.9g %ld", created, now() - start - created, steps);
    for (int i = 0; i < c->times * c->unknowns; i++)
        std::printf(" %.17g", values[i]);
    std::printf("\n");
}

int main(int argc, char **argv) {
    bench_case c;
    for (int i = 0; argc == 5 && case_make(i, 0, &c); i++) {
        if (std::strcmp(c.name, argv[1]) == 0) {
            const double x0[16] = {c.system ? 0.0 : 10.0};
            ns_system *s = c.system ? c.system : system_lc_bridge();
            run(&c, s, x0, std::atoi(argv[2]), std::atof(argv[3]), std::atof(argv[4]));
            return 0;
        }
        case_free(&c);
    }
    return 2;
}
