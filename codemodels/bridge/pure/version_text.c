/* bridge/pure/version_text.c - the version of ngspice, as its memory shows it. */
#include "version_text.h"

#include <stdlib.h>
#include <string.h>

static const char beside[] = "Please file your bug-reports at ";

enum {
    NEAR = 80
}; /* bytes before and after that text, in which the version lies: it is aligned to 32 at most */

static const char *find(const char *data, size_t size) {
    const size_t length = sizeof beside - 1;
    const char *end = data + size;
    while ((size_t)(end - data) >= length) {
        const char *at = memchr(data, beside[0], (size_t)(end - data) - length + 1);
        if (!at || memcmp(at, beside, length) == 0)
            return at;
        data = at + 1;
    }
    return NULL;
}

/* 1 if the text is "39", "44.2" or "46+". */
static int is_version(const char *text, size_t length) {
    size_t digits = strspn(text, "0123456789");
    if (length < 2 || length >= VERSION_TEXT || digits != 2)
        return 0;
    if (text[digits] == '.')
        digits += 1 + strspn(text + digits + 1, "0123456789");
    return digits + (text[digits] == '+') == length;
}

/* Looks at each text that ends with a 0 between the two addresses; keeps the versions, returns how many. */
static int read_versions(const char *from, const char *end, char version[VERSION_TEXT]) {
    int n = 0;
    while (from < end) {
        const char *stop = memchr(from, 0, (size_t)(end - from));
        if (!stop)
            break;
        const size_t length = (size_t)(stop - from);
        if (is_version(from, length)) {
            memcpy(version, from, length + 1);
            n++;
        }
        from = stop + 1;
    }
    return n;
}

int ns_bridge_version_text(const char *data, size_t size, char version[VERSION_TEXT]) {
    const char *end = data + size;
    const char *text = find(data, size);
    const char *after = text ? memchr(text, 0, (size_t)(end - text)) : NULL;
    if (!after)
        return 0;
    const char *before = text - data > NEAR ? text - NEAR : data;
    const char *last = end - after > NEAR ? after + NEAR : end;
    const int n = read_versions(after, last, version);
    return n == 1 || (n == 0 && read_versions(before, text, version) == 1);
}

int ns_bridge_version_major(const char *version) {
    return atoi(version) + (strchr(version, '+') != NULL);
}
