/* bridge/module_memory.c - the memory of the program or library that holds an address, on Linux (ELF),
 * Windows (PE) and macOS (Mach-O). */
#define _GNU_SOURCE /* dl_iterate_phdr() */
#include "module_memory.h"

#include <stdint.h>
#include <string.h>

#if defined(_WIN32)
#include <windows.h>

/* The largest section that has all of `flags`. */
static int find_section(const void *address, DWORD flags, ns_module_memory *found) {
    HMODULE module;
    const DWORD by_address =
        GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    found->size = 0;
    if (!GetModuleHandleExA(by_address, (LPCSTR)address, &module))
        return 0;
    const char *base = (const char *)module;
    const IMAGE_NT_HEADERS *header =
        (const IMAGE_NT_HEADERS *)(const void *)(base +
                                                 ((const IMAGE_DOS_HEADER *)(const void *)base)->e_lfanew);
    const IMAGE_SECTION_HEADER *section = IMAGE_FIRST_SECTION(header);
    for (int k = 0; k < header->FileHeader.NumberOfSections; k++, section++)
        if ((section->Characteristics & flags) == flags && section->Misc.VirtualSize > found->size)
            *found = (ns_module_memory){base + section->VirtualAddress, section->Misc.VirtualSize};
    return found->size > 0;
}

int ns_bridge_module_code(const void *address, ns_module_memory *code) {
    return find_section(address, IMAGE_SCN_CNT_CODE | IMAGE_SCN_MEM_EXECUTE, code);
}

int ns_bridge_module_data(const void *address, ns_module_memory *data) {
    return find_section(address, IMAGE_SCN_CNT_INITIALIZED_DATA | IMAGE_SCN_MEM_WRITE, data);
}

#elif defined(__APPLE__)
#include <dlfcn.h>
#include <mach-o/getsect.h>

static int find_section(const void *address, const char *segment, const char *section,
                        ns_module_memory *found) {
    Dl_info module;
    unsigned long size = 0;
    if (!dladdr(address, &module))
        return 0;
    const uint8_t *data =
        getsectiondata((const struct mach_header_64 *)module.dli_fbase, segment, section, &size);
    *found = (ns_module_memory){(const char *)data, size};
    return data != NULL;
}

int ns_bridge_module_code(const void *address, ns_module_memory *code) {
    return find_section(address, "__TEXT", "__text", code);
}

int ns_bridge_module_data(const void *address, ns_module_memory *data) {
    return find_section(address, "__DATA", "__data", data);
}

#else
#include <link.h>

typedef struct wanted_segment {
    const char *address;
    ElfW(Word) flags;
    ns_module_memory found;
} wanted_segment;

static int look_at(struct dl_phdr_info *module, size_t size, void *argument) {
    wanted_segment *wanted = argument;
    int holds = 0;
    (void)size;
    /* NOLINTBEGIN(performance-no-int-to-ptr): addresses are numbers there */
    for (int k = 0; k < module->dlpi_phnum; k++) {
        const ElfW(Phdr) *part = &module->dlpi_phdr[k];
        const char *from = (const char *)(uintptr_t)(module->dlpi_addr + part->p_vaddr);
        holds |= part->p_type == PT_LOAD && wanted->address >= from && wanted->address < from + part->p_memsz;
    }
    for (int k = 0; k < module->dlpi_phnum && holds; k++) {
        const ElfW(Phdr) *part = &module->dlpi_phdr[k];
        if (part->p_type == PT_LOAD && (part->p_flags & wanted->flags))
            wanted->found = (ns_module_memory){(const char *)(uintptr_t)(module->dlpi_addr + part->p_vaddr),
                                               part->p_filesz};
    }
    /* NOLINTEND(performance-no-int-to-ptr) */
    return holds; /* ends the iteration */
}

static int find_segment(const void *address, uint32_t flags, ns_module_memory *found) {
    wanted_segment wanted = {address, flags, {NULL, 0}};
    dl_iterate_phdr(look_at, &wanted);
    *found = wanted.found;
    return found->size > 0;
}

int ns_bridge_module_code(const void *address, ns_module_memory *code) {
    return find_segment(address, PF_X, code);
}

int ns_bridge_module_data(const void *address, ns_module_memory *data) {
    return find_segment(address, PF_W, data);
}
#endif
