/* bridge/foreign.c - code models of other libraries: which model an instance is of.
 *
 * ngspice does not export its table of devices.  But every `.cm` exports its own (CMdevs), ngspice appends
 * them in the order in which the libraries are loaded, and knows an instance's type by its number in the
 * whole table: counted from the number of one of our types, it tells the library and the model.  The names of
 * the model's terminals, which instances share with the table by address, prove it. */
#define _GNU_SOURCE /* dl_iterate_phdr() */
#include "foreign.h"

#include <string.h>

#if defined(_WIN32) || defined(__APPLE__)
#define HAS_NO_LIST_OF_LIBRARIES
#else
#include <dlfcn.h>
#include <link.h>
#endif

#include "ngspice/mifparse.h"

#include "models.h"

typedef void *table_function(void);
extern table_function CMdevs; /* of our own library */

enum { LIBRARIES = 64 };

typedef struct library {
    SPICEdev **model;
    int count;
} library;

typedef struct libraries {
    int count;
    library of[LIBRARIES]; /* in the order in which they were loaded */
} libraries;

#ifndef HAS_NO_LIST_OF_LIBRARIES
/* Of one shared object: keeps its models, if it is a library of code models. */
static int look_into(struct dl_phdr_info *info, size_t size, void *data) {
    libraries *all = data;
    void *const object =
        info->dlpi_name && *info->dlpi_name ? dlopen(info->dlpi_name, RTLD_LAZY | RTLD_NOLOAD) : NULL;
    (void)size;
    if (!object)
        return 0;
    table_function *models, *count;
    *(void **)&models = dlsym(object, "CMdevs");
    *(void **)&count = dlsym(object, "CMdevNum");
    if (models && count && all->count < LIBRARIES)
        all->of[all->count++] = (library){models(), *(const int *)count()};
    dlclose(object);
    return 0;
}

static void list_libraries(libraries *all) {
    (void)dl_iterate_phdr(look_into, all);
}
#else
static void list_libraries(libraries *all) {
    (void)all;
}
#endif

static int place_in(const library *l, const char *name) {
    for (int i = 0; i < l->count; i++)
        if (strcmp(l->model[i]->DEVpublic.name, name) == 0)
            return i;
    return -1;
}

/* The number of the first type of each library, by that of one of ours; 0: ours was not found. */
static int number_types(const libraries *all, int *first) {
    const char *ours;
    const int type = ns_bridge_models_any(&ours);
    int at = 0, found = 0;
    for (int k = 0; k < all->count; k++) {
        first[k] = at;
        at += all->of[k].count;
    }
    for (int k = 0; k < all->count && !found && type >= 0; k++) {
        const int place = all->of[k].model == CMdevs() ? place_in(&all->of[k], ours) : -1;
        const int shift = type - place - first[k];
        for (int i = 0; i < all->count && place >= 0; i++)
            first[i] += shift;
        found = place >= 0;
    }
    return found;
}

/* 1 if inst has the terminals of this model. */
static int fits(const SPICEdev *model, const MIFinstance *inst) {
    if (model->DEVpublic.num_conn != inst->num_conn)
        return 0;
    for (int i = 0; i < inst->num_conn; i++)
        if (model->DEVpublic.conn[i].name != inst->conn[i]->name)
            return 0;
    return 1;
}

static SPICEdev *find_model(const MIFinstance *inst, int type) {
    libraries all = {0};
    int first[LIBRARIES];
    list_libraries(&all);
    if (!number_types(&all, first))
        return NULL;
    for (int k = 0; k < all.count; k++) {
        const int place = type - first[k];
        if (place >= 0 && place < all.of[k].count && fits(all.of[k].model[place], inst))
            return all.of[k].model[place];
    }
    return NULL;
}

/* A type keeps its number, so what was found is kept: to list the libraries takes half a million
 * instructions. */
IFdevice *ns_bridge_foreign_type(const MIFinstance *inst) {
    enum { KEPT = 64 };
    static struct {
        int type;
        SPICEdev *model;
    } kept[KEPT];
    const int type = inst->gen.GENmodPtr->GENmodType, at = type % KEPT;
    if (!kept[at].model || kept[at].type != type || !fits(kept[at].model, inst)) {
        kept[at].type = type;
        kept[at].model = find_model(inst, type);
    }
    return kept[at].model ? &kept[at].model->DEVpublic : NULL;
}

const char *ns_bridge_foreign_model(const MIFinstance *inst) {
    const IFdevice *type = ns_bridge_foreign_type(inst);
    return type ? type->name : NULL;
}
