/* bridge/loaded.c - is the ngspice that loads nonsmooth.cm the one it was made for?
 *
 * ngspice's loader checks nothing, and tells a code model nothing.  But when it has called CMgetCoreItfPtr():
 * - it wrote two addresses into each of our SPICEdev structs, DEVinstSize and DEVmodSize.  They lie elsewhere
 * if it was configured otherwise (OSDI adds a pointer before them, CIDER two);
 * - they are addresses of its own data, in which its version stands as text;
 * - what they point to are the sizes of its MIFinstance and MIFmodel, which have grown in 42 and 47.
 * If one of these differs our models get names that no netlist has: ngspice would misread their tables.
 * Later the table of ngspice's functions is known: KLU adds three to it, most versions some. */
#include "loaded.h"

#include <string.h>

#include "module_memory.h"
#include "pure/version_text.h"
#include "report.h"
#include "versions.h"

#include "ngspice/dllitf.h"

#ifdef KLU
#define WITH_KLU ", KLU"
#else
#define WITH_KLU ", no KLU"
#endif
#ifdef CIDER
#define WITH_CIDER ", CIDER"
#else
#define WITH_CIDER ", no CIDER"
#endif
#ifdef OSDI
#define WITH_OSDI ", OSDI"
#else
#define WITH_OSDI ", no OSDI"
#endif

enum { TYPES_MAX = 8, ROOM = 8, CORE_FUNCTIONS = sizeof(struct coreInfo_t) / sizeof(void *) };

typedef union roomy_type {
    SPICEdev type;
    void *word[sizeof(SPICEdev) / sizeof(void *) + ROOM]; /* ngspice's struct may be larger than ours */
} roomy_type;

static roomy_type given[TYPES_MAX];
static roomy_type first_before; /* given[0] before ngspice has seen it */
static int ngiven;
static int is_other;

extern SPICEdev *cmDEVices[]; /* dlmain.c: what ngspice is given; ends with NULL */
extern struct coreInfo_t *coreitf;
void *ns_bridge_dlmain_core(void); /* its CMgetCoreItfPtr() */

void ns_bridge_loaded_prepare(SPICEdev **types, int n) {
    for (int k = 0; k < n && k < TYPES_MAX; k++) {
        given[k].type = *types[k];
        given[k].type.DEVinstSize = given[k].type.DEVmodSize = NULL;
        for (SPICEdev **listed = cmDEVices; *listed; listed++)
            if (*listed == types[k])
                *listed = &given[k].type;
        types[k] = &given[k].type;
        ngiven = k + 1;
    }
    first_before = given[0];
}

/* --- when ngspice loads the library --- */

/* The first of the two addresses that ngspice wrote, or NULL. */
static const int *written(void) {
    for (size_t k = 0; k < sizeof given[0].word / sizeof given[0].word[0]; k++)
        if (given[0].word[k] != first_before.word[k])
            return given[0].word[k];
    return NULL;
}

static int version_of(const void *address, char version[VERSION_TEXT]) {
    ns_module_memory data;
    return ns_bridge_module_data(address, &data) && ns_bridge_version_text(data.data, data.size, version);
}

static void withdraw(void) {
    static char name[] = "(of another ngspice)";
    for (int k = 0; k < ngiven; k++)
        given[k].type.DEVpublic.name = name;
    is_other = 1;
}

/* ngspice has no console for us yet, and a host of libngspice gets this on its own. */
static void refuse(const char *is, const char *version) {
    fflush(stdout);
    fprintf(stderr,
            "nonsmooth: nonsmooth.cm, made for ngspice %d" WITH_KLU WITH_CIDER WITH_OSDI
            ", was loaded by an ngspice %s%s: its models are not there; see codemodels/README.md\n",
            NGSPICE_MAJOR, is, version);
    withdraw();
}

static void check(void) {
    const SPICEdev *type = &given[0].type;
    char version[VERSION_TEXT];
    const int *sizes = written();
    if (!sizes)
        return; /* nothing was written: this is not the loader that is known */
    if (version_of(sizes, version) && ns_bridge_version_major(version) != NGSPICE_MAJOR)
        refuse("of version ", version);
    else if (!type->DEVinstSize || !type->DEVmodSize)
        refuse("configured otherwise (CIDER, OSDI)", "");
    else if (*type->DEVinstSize != (int)sizeof(MIFinstance) || *type->DEVmodSize != (int)sizeof(MIFmodel))
        refuse("of another version", "");
}

#ifdef _WIN32
__declspec(dllexport)
#endif
    void *CMgetCoreItfPtr(void); /* what ngspice calls last when it loads the library */

void *CMgetCoreItfPtr(void) {
    if (ngiven > 0 && !is_other)
        check();
    return ns_bridge_dlmain_core();
}

/* --- before the first setup --- */

/* Functions of ngspice from the beginning of its table on. */
static int count_functions(void) {
    const char *const *entry = (const char *const *)(const void *)coreitf;
    ns_module_memory code;
    int n = 0;
    if (!ns_bridge_module_code(entry[0], &code))
        return CORE_FUNCTIONS;
    while (n < 2 * CORE_FUNCTIONS && entry[n] >= code.data && entry[n] < code.data + code.size)
        n++;
    return n;
}

/* What follows the table may look like a function: only KLU's three count. */
static int table_differs(void) {
    const int more = count_functions() - CORE_FUNCTIONS;
    return more < 0 || ns_bridge_versions_more_of_klu(more);
}

int ns_bridge_loaded_is_other(void) {
    static int checked;
    if (!checked && !is_other && table_differs()) {
        ns_bridge_report_error("nonsmooth.cm, made for ngspice %d" WITH_KLU WITH_CIDER WITH_OSDI
                               ", was loaded by an ngspice of another version or configured otherwise (KLU): "
                               "see codemodels/README.md",
                               NGSPICE_MAJOR);
        is_other = 1;
    }
    checked = 1;
    return is_other;
}
