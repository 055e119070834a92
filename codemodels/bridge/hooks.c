/* bridge/hooks.c - puts the bridge between ngspice and our code models.
 *
 * The SPICEdev structs that cmpp makes are plain data: when the library is loaded, some of their functions
 * are replaced.  One bridge is kept a circuit.  ngspice runs device types by number, so the functions of the
 * last of our types see everything that came before: they do the work. */
#include <string.h>

#include "branches.h"
#include "loaded.h"
#include "models.h"
#include "refused.h"
#include "report.h"
#include "session.h"
#include "show.h"
#include "taken.h"
#include "versions.h"

extern SPICEdev cm_ideal_diode_info, cm_ideal_switch_info, cm_nonsmooth_info; /* made by cmpp */

static SPICEdev *ours[KINDS] = {&cm_ideal_diode_info, &cm_ideal_switch_info, &cm_nonsmooth_info};

typedef struct ns_bridge {
    struct ns_bridge *next;
    ns_session session;
    int last_type;           /* the last of our device types in this circuit; 0: none is there */
    const GENinstance *mark; /* one of our instances: when it is deleted, the circuit is */
    int left_noted;          /* 1: the user was told that the circuit holds no ideal device */
} ns_bridge;

static ns_bridge *bridges;

static ns_bridge *find_bridge(const CKTcircuit *ckt) {
    ns_bridge *b = bridges;
    while (b && b->session.ckt != ckt)
        b = b->next;
    return b;
}

static ns_bridge *find_or_make_bridge(CKTcircuit *ckt) {
    ns_bridge *b = find_bridge(ckt);
    if (!b && (b = calloc(1, sizeof *b))) {
        b->session.ckt = ckt;
        b->next = bridges;
        bridges = b;
    }
    return b;
}

/* The bridge of ckt if model is of the last of our types, else NULL. */
static ns_session *at_last(CKTcircuit *ckt, const GENmodel *model) {
    ns_bridge *b = find_bridge(ckt);
    if (!b || b->last_type != model->GENmodType)
        return NULL;
    ns_bridge_report_about(ckt, b->last_type);
    return &b->session;
}

/* 1 if an option says that ngspice's own devices are taken. */
static int takes_any(const GENmodel *model) {
    for (; model; model = model->GENnextModel) {
        for (const GENinstance *inst = model->GENinstances; inst; inst = inst->GENnextInstance) {
            const char *take = ns_bridge_models_text((const MIFinstance *)inst, OPTION_TAKE);
            const char *mosfet = ns_bridge_models_text((const MIFinstance *)inst, OPTION_MOSFET);
            if ((take && strcmp(take, "none") != 0) || (mosfet && strcmp(mosfet, "none") != 0))
                return 1;
        }
    }
    return 0;
}

/* Options alone leave the circuit to ngspice. */
static void note_left(ns_bridge *b) {
    if (b->last_type || b->left_noted)
        return;
    b->left_noted = 1;
    ns_bridge_report_note("no ideal device and no take=...: ngspice itself simulates this circuit");
}

static int setup_type(model_kind kind, SMPmatrix *matrix, GENmodel *model, CKTcircuit *ckt, int *states) {
    ns_bridge_report_about(ckt, model->GENmodType);
    int error = ns_bridge_analysis_check_setup(ckt);
    ns_bridge *b = error ? NULL : find_or_make_bridge(ckt);
    if (!b)
        return error ? error : E_NOMEM;
    ns_bridge_models_set_type(kind, model->GENmodType);
    b->mark = model->GENinstances ? model->GENinstances : b->mark;
    error = MIFsetup(matrix, model, ckt, states);
    if (kind != KIND_OPTIONS || (!error && takes_any(model)))
        b->last_type = model->GENmodType;
    else if (!error)
        note_left(b);
    return error;
}

static int setup_diode(SMPmatrix *matrix, GENmodel *model, CKTcircuit *ckt, int *states) {
    return setup_type(KIND_DIODE, matrix, model, ckt, states);
}

static int setup_switch(SMPmatrix *matrix, GENmodel *model, CKTcircuit *ckt, int *states) {
    return setup_type(KIND_SWITCH, matrix, model, ckt, states);
}

static int setup_options(SMPmatrix *matrix, GENmodel *model, CKTcircuit *ckt, int *states) {
    return setup_type(KIND_OPTIONS, matrix, model, ckt, states);
}

static int unsetup_type(GENmodel *model, CKTcircuit *ckt) {
    ns_bridge *b = find_bridge(ckt);
    ns_bridge_branches_rename(ckt, model, BRANCH_AS_MADE);
    if (b)
        ns_bridge_session_reset(&b->session);
    return MIFunsetup(model, ckt);
}

/* F, H and W ask for the branch current of a device before it has one; ngspice then says that there is no
 * such source. */
static int find_branch(CKTcircuit *ckt, GENmodel *model, IFuid name) {
    for (; model; model = model->GENnextModel) {
        for (const GENinstance *inst = model->GENinstances; inst; inst = inst->GENnextInstance) {
            if (strcmp(inst->GENname, name) != 0)
                continue;
            ns_bridge_report_about(ckt, model->GENmodType);
            ns_bridge_report_error(
                "%s: F, H and W cannot be controlled by its current: put a source of 0 V in series, or use B",
                name);
        }
    }
    return 0;
}

/* Values are known from here on.  Only before an analysis: ngspice exits if this fails for an
 * `altermod` between. */
static int check_circuit(GENmodel *model, CKTcircuit *ckt) {
    ns_session *s = at_last(ckt, model);
    const int error = s && ckt->CKTtime == 0.0 ? ns_bridge_analysis_check(s) : OK;
    for (int k = 0; s && !error && k < KINDS; k++)
        if (ns_bridge_models_type(k) >= 0)
            ns_bridge_branches_rename(ckt, ckt->CKThead[ns_bridge_models_type(k)], BRANCH_AS_OF_A_SOURCE);
    return error;
}

static int load_point(GENmodel *model, CKTcircuit *ckt) {
    ns_session *s = at_last(ckt, model);
    return s ? ns_bridge_session_load(s) : OK;
}

static int accept_point(CKTcircuit *ckt, GENmodel *model) {
    ns_session *s = at_last(ckt, model);
    return s ? ns_bridge_session_accept(s) : OK;
}

/* After a point is shown. */
static void arm_single_load(GENmodel *model, CKTcircuit *ckt) {
    ns_session *s = at_last(ckt, model);
    if (s)
        ns_bridge_single_load_arm(s);
}

/* An error ends the analysis. */
static int refuse_ac(GENmodel *model, CKTcircuit *ckt) {
    const ns_bridge *b = find_bridge(ckt);
    if (!b || !b->last_type)
        return MIFload(model, ckt);
    ns_bridge_report_about(ckt, b->last_type);
    return ns_bridge_refused_end(ckt);
}

/* What a device shows is written when someone asks. */
static int ask_instance(CKTcircuit *ckt, GENinstance *inst, int which, IFvalue *value, IFvalue *select) {
    ns_bridge *b = find_bridge(ckt);
    const int show = which - MIFmodPtr((MIFinstance *)inst)->num_param;
    if (b && b->session.analysis.march) {
        if (show == SHOW_Q || show == SHOW_E)
            ns_bridge_taken_ask(&b->session.analysis);
        ns_bridge_show_devices(&b->session.analysis);
    }
    return MIFask(ckt, inst, which, value, select);
}

static int delete_instance(GENinstance *inst) {
    for (ns_bridge **link = &bridges; *link; link = &(*link)->next) {
        ns_bridge *b = *link;
        if (b->mark == inst) {
            *link = b->next;
            ns_bridge_session_clear(&b->session);
            free(b);
            break;
        }
    }
    return MIFdelete(inst);
}

/* Lets any step pass: points of the library have no truncation error, and a jump must not count as one. */
static int allow_any_step(GENmodel *model, CKTcircuit *ckt, double *step) {
    if (at_last(ckt, model))
        *step = 1e30;
    return OK;
}

/* Our matrices are small: OpenBLAS's threads only wait for each other, spinning.  Another BLAS has no such
 * function; only ELF allows a weak reference to one that may be missing. */
#ifdef __ELF__
extern void openblas_set_num_threads(int n) __attribute__((weak));
#endif

static void use_one_thread(void) {
#ifdef __ELF__
    if (openblas_set_num_threads)
        openblas_set_num_threads(1);
#endif
}

__attribute__((__constructor__)) static void install(void) {
    static int (*const setups[KINDS])(SMPmatrix *, GENmodel *, CKTcircuit *,
                                      int *) = {setup_diode, setup_switch, setup_options};
    for (int k = 0; k < KINDS; k++) {
        ours[k]->DEVsetup = setups[k];
        ours[k]->DEVunsetup = unsetup_type;
        ours[k]->DEVtemperature = check_circuit;
        ours[k]->DEVfindBranch = find_branch;
        ours[k]->DEVload = load_point;
        ours[k]->DEVaccept = accept_point;
        ours[k]->DEVacLoad = refuse_ac;
        ours[k]->DEVdelete = delete_instance;
        ours[k]->DEVtrunc = allow_any_step;
        ours[k]->DEVask = ask_instance;
        ours[k]->DEVpublic.cm_func = ns_bridge_report_cm_func;
        ns_bridge_versions_hook_shown(ours[k], arm_single_load);
    }
    ns_bridge_loaded_prepare(ours, KINDS);
    use_one_thread();
}
