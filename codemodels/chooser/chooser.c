/* chooser/chooser.c - nonsmooth.cm as it is installed: takes the code models of the ngspice that loads it.
 *
 * A code-model library belongs to one version of ngspice.  This one has no models and reads nothing of
 * ngspice's but its version, which stands as text in the data of the program or library that calls
 * CMdevNum().  It loads nonsmooth-NN.cm, which lies beside it, and hands over what that has.  Without one
 * ngspice gets no models, and the user one line. */
#define _GNU_SOURCE /* dladdr() */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "module_memory.h"
#include "pure/version_text.h"

#ifdef _WIN32
#include <windows.h>
#define EXPORT __declspec(dllexport)
#else
#include <dlfcn.h>
#define EXPORT __attribute__((visibility("default")))
#endif

enum { PATH_SIZE = 4096 };

typedef void *getter(void);

EXPORT void *CMdevs(void);
EXPORT void *CMdevNum(void);
EXPORT void *CMudns(void);
EXPORT void *CMudnNum(void);
EXPORT void *CMgetCoreItfPtr(void);

static void *models; /* the library that was chosen, NULL: none */

/* The path of this library up to its name, "" if it is not known. */
static void own_folder(char *path, size_t size) {
    char *slash;
    path[0] = '\0';
#ifdef _WIN32
    HMODULE self;
    if (GetModuleHandleExA(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS |
                               GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
                           (LPCSTR)(uintptr_t)&CMdevNum, &self))
        GetModuleFileNameA(self, path, (DWORD)size);
    for (char *c = path; *c; c++)
        if (*c == '\\')
            *c = '/';
#else
    Dl_info self; /* NOLINTNEXTLINE(performance-no-int-to-ptr): of a function */
    if (dladdr((void *)(uintptr_t)&CMdevNum, &self) && self.dli_fname && strlen(self.dli_fname) < size)
        memcpy(path, self.dli_fname, strlen(self.dli_fname) + 1);
#endif
    slash = strrchr(path, '/');
    *(slash ? slash + 1 : path) = '\0';
}

static void *open_library(const char *path) {
#ifdef _WIN32
    return (void *)LoadLibraryA(path);
#else
    return dlopen(path, RTLD_NOW);
#endif
}

static const char *why_not(void) {
#ifdef _WIN32
    return "it cannot be loaded";
#else
    return dlerror();
#endif
}

static getter *function(const char *name) {
#ifdef _WIN32
    return (getter *)(uintptr_t)GetProcAddress((HMODULE)models, name);
#else
    return (getter *)(uintptr_t)dlsym(models, name); /* NOLINT(performance-no-int-to-ptr): a function */
#endif
}

/* ngspice has no console for a library that it loads. */
static void load_models(const void *caller) {
    ns_module_memory data;
    char version[VERSION_TEXT];
    char folder[PATH_SIZE];
    char path[PATH_SIZE + 32];
    own_folder(folder, sizeof folder);
    fflush(stdout);
    if (!ns_bridge_module_data(caller, &data) || !ns_bridge_version_text(data.data, data.size, version)) {
        fprintf(
            stderr,
            "nonsmooth: the version of this ngspice is not known: load %snonsmooth-NN.cm, NN its version\n",
            folder);
        return;
    }
    snprintf(path, sizeof path, "%snonsmooth-%d.cm", folder, ns_bridge_version_major(version));
    models = open_library(path);
    if (!models)
        fprintf(stderr,
                "nonsmooth: no code models for this ngspice, version %s: %s; see codemodels/README.md\n",
                version, why_not());
}

/* What the models' function of that name returns, or `instead`. */
static void *ask(const char *name, void *instead) {
    getter *get = models ? function(name) : NULL;
    return get ? get() : instead;
}

EXPORT void *CMdevNum(void) { /* ngspice asks for this first */
    static int none;
    if (!models)
        load_models(__builtin_return_address(0));
    return ask("CMdevNum", &none);
}

EXPORT void *CMdevs(void) {
    static void *none[1];
    return ask("CMdevs", none);
}

EXPORT void *CMudnNum(void) {
    static int none;
    return ask("CMudnNum", &none);
}

EXPORT void *CMudns(void) {
    static void *none[1];
    return ask("CMudns", none);
}

EXPORT void *CMgetCoreItfPtr(void) {
    static void *unused;
    return ask("CMgetCoreItfPtr", &unused);
}
