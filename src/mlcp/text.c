/* src/mlcp/text.c - a problem as plain text: the reader, the writer. */
#define _POSIX_C_SOURCE 200809L /* newlocale(), uselocale() */
#include "nonsmooth/text.h"
#include "mlcp_internal.h"

#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __APPLE__
#include <xlocale.h>
#endif

/* The longest decimal that a double can have in full takes 767 digits and a point. */
enum { TOKEN_MAX = 1000, SHOWN_MAX = 24, FIRST_ROOM = 64 };

/* --- the locale of the calling thread, put away while numbers are read or written --- */

#ifdef _WIN32
typedef struct c_locale {
    int per_thread; /* whether the thread had a locale of its own */
    char *before;
} c_locale;

static int enter_c_locale(c_locale *l) {
    l->per_thread = _configthreadlocale(_ENABLE_PER_THREAD_LOCALE);
    const char *now = setlocale(LC_ALL, NULL);
    const size_t size = now ? strlen(now) + 1 : 0;
    l->before = malloc(size + 1);
    if (!l->before) {
        _configthreadlocale(l->per_thread);
        return NS_E_MEMORY;
    }
    memcpy(l->before, now ? now : "", size);
    l->before[size] = '\0';
    setlocale(LC_ALL, "C");
    return NS_OK;
}

static void leave_c_locale(const c_locale *l) {
    setlocale(LC_ALL, l->before);
    _configthreadlocale(l->per_thread);
    free(l->before);
}
#else
typedef struct c_locale {
    locale_t c, before;
} c_locale;

static int enter_c_locale(c_locale *l) {
    l->c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (l->c == (locale_t)0)
        return NS_E_MEMORY;
    l->before = uselocale(l->c);
    return NS_OK;
}

static void leave_c_locale(const c_locale *l) {
    uselocale(l->before);
    freelocale(l->c);
}
#endif

/* --- the reader --- */

typedef struct reader {
    const char *at, *end;
    long now;  /* line of at */
    long line; /* of the present token, the last one at the end */
    int m;
    double *number; /* what was read after m, in the order of the text */
    size_t count, room;
    uint64_t wanted;   /* m*m + 3m */
    const char *token; /* the present one */
    size_t length;
    ns_text_fault *fault;
} reader;

static int is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* 0: the text is at its end. */
static int next_token(reader *r) {
    int comment = 0;
    for (; r->at < r->end && (comment || is_space(*r->at) || *r->at == '#'); r->at++) {
        r->now += *r->at == '\n';
        comment = *r->at != '\n' && (comment || *r->at == '#');
    }
    r->token = r->at;
    while (r->at < r->end && !is_space(*r->at) && *r->at != '#')
        r->at++;
    r->length = (size_t)(r->at - r->token);
    r->line = r->length > 0 ? r->now : r->line;
    return r->length > 0;
}

#if defined(__GNUC__)
__attribute__((__format__(__printf__, 3, 4)))
#endif
static int
refuse(const reader *r, int status, const char *format, ...) {
    va_list values;
    va_start(values, format);
    r->fault->line = r->line;
    vsnprintf(r->fault->cause, sizeof r->fault->cause, format, values);
    va_end(values);
    return status;
}

/* The present token, in quotes, for a message: cut, and nothing that a terminal would take amiss. */
static const char *shown(const reader *r, char out[SHOWN_MAX + 6]) {
    const size_t n = r->length < SHOWN_MAX ? r->length : SHOWN_MAX;
    out[0] = '\'';
    for (size_t i = 0; i < n; i++)
        out[1 + i] = (char)(r->token[i] > ' ' && r->token[i] <= '~' ? r->token[i] : '?');
    snprintf(out + 1 + n, 5, n < r->length ? "'..." : "'");
    return out;
}

/* Which number the k-th after m is: "W(2,3)", "q(1)". */
static const char *name_of(const reader *r, uint64_t k, char out[48]) {
    const uint64_t m = (uint64_t)r->m;
    const unsigned long long row = m ? k / m + 1 : 0, column = m ? k % m + 1 : 0;
    if (k < m * m)
        snprintf(out, 48, "W(%llu,%llu)", row, column);
    else
        snprintf(out, 48, "%c(%llu)", row - 1 == m ? 'q' : row - 2 == m ? 'l' : 'u', column);
    return out;
}

/* A decimal number of C, with a sign or without: what strtod() takes besides is not for us. */
static int is_decimal(const char *s) {
    static const char digits[] = "0123456789";
    s += *s == '-' || *s == '+';
    size_t count = strspn(s, digits);
    s += count;
    if (*s == '.') {
        const size_t behind = strspn(++s, digits);
        s += behind;
        count += behind;
    }
    if (count > 0 && (*s == 'e' || *s == 'E')) {
        s++;
        s += *s == '-' || *s == '+';
        count = strspn(s, digits);
        s += count;
    }
    return count > 0 && *s == '\0';
}

static int equal_letters(const char *s, const char *lower) {
    for (; *lower; s++, lower++)
        if (*s != *lower && *s != *lower - 'a' + 'A')
            return 0;
    return *s == '\0';
}

/* 1, -1: an infinity; 0: not one. */
static int infinity_sign(const char *s) {
    const int sign = *s == '-' ? -1 : 1;
    s += *s == '-' || *s == '+';
    return equal_letters(s, "inf") || equal_letters(s, "infinity") ? sign : 0;
}

/* The present token as a number, which is the next after m. */
static int parse(const reader *r, double *value) {
    char text[TOKEN_MAX + 1], name[48], quoted[SHOWN_MAX + 6];
    name_of(r, r->count, name);
    shown(r, quoted);
    if (r->length > TOKEN_MAX)
        return refuse(r, NS_E_NUMBER, "%s is %s, longer than %d characters", name, quoted, TOKEN_MAX);
    memcpy(text, r->token, r->length);
    text[r->length] = '\0';
    if (strlen(text) == r->length && is_decimal(text)) {
        *value = strtod(text, NULL);
        return isfinite(*value)
                   ? NS_OK
                   : refuse(r, NS_E_NUMBER, "%s is %s, more than a double can hold", name, quoted);
    }
    const int sign = strlen(text) == r->length ? infinity_sign(text) : 0;
    if (sign == 0)
        return refuse(r, NS_E_NUMBER, "%s is %s, which is no number", name, quoted);
    if (*name != 'l' && *name != 'u')
        return refuse(r, NS_E_NUMBER, "%s is infinite; only l and u may be", name);
    *value = sign > 0 ? INFINITY : -INFINITY;
    return NS_OK;
}

/* m: digits only, after a sign perhaps. */
static int parse_m(reader *r) {
    char quoted[SHOWN_MAX + 6];
    const char *s = r->token, *end = s + r->length;
    const int negative = *s == '-';
    long long m = 0;
    s += negative || *s == '+';
    if (s == end)
        return refuse(r, NS_E_NUMBER, "m is %s, which is no number", shown(r, quoted));
    for (; s < end; s++) {
        if (*s < '0' || *s > '9')
            return refuse(r, NS_E_NUMBER, "m is %s, which is no integer", shown(r, quoted));
        m = m <= INT_MAX ? 10 * m + (*s - '0') : m;
    }
    if (negative && m > 0)
        return refuse(r, NS_E_SIZE, "m is %s, below 0", shown(r, quoted));
    if (m > INT_MAX)
        return refuse(r, NS_E_SIZE, "m is %s, too large", shown(r, quoted));
    r->m = (int)m;
    r->wanted = (uint64_t)m * (uint64_t)m + 3 * (uint64_t)m;
    return NS_OK;
}

/* Grows with what was read, not with what m promises. */
static int make_room(reader *r) {
    if (r->count < r->room)
        return NS_OK;
    size_t room = r->room ? 2 * r->room : FIRST_ROOM;
    if (room > r->wanted)
        room = (size_t)r->wanted;
    double *more = room <= SIZE_MAX / sizeof *more ? realloc(r->number, room * sizeof *more) : NULL;
    if (!more)
        return NS_E_MEMORY;
    r->number = more;
    r->room = room;
    return NS_OK;
}

/* u_i was read: does it fit l_i? */
static int check_bounds(const reader *r) {
    const size_t m = (size_t)r->m;
    if (r->count < r->wanted - m)
        return NS_OK;
    const double l = r->number[r->count - m], u = r->number[r->count];
    const size_t i = r->count - (size_t)(r->wanted - m) + 1;
    if (l > u)
        return refuse(r, NS_E_BOUNDS, "l(%zu) = %.17g is above u(%zu) = %.17g", i, l, i, u);
    if (l == u && isinf(l))
        return refuse(r, NS_E_BOUNDS, "l(%zu) and u(%zu) are both %g", i, i, l);
    return NS_OK;
}

static int read_numbers(reader *r) {
    char text[SHOWN_MAX + 48];
    for (; r->count < r->wanted; r->count++) {
        if (!next_token(r))
            return refuse(r, NS_E_SIZE, "the text ends before %s, after %zu of %llu numbers",
                          name_of(r, r->count, text), r->count, (unsigned long long)r->wanted);
        int status = make_room(r);
        status = status ? status : parse(r, &r->number[r->count]);
        status = status ? status : check_bounds(r);
        if (status != NS_OK)
            return status;
    }
    if (next_token(r))
        return refuse(r, NS_E_SIZE, "%s after the last number", shown(r, text));
    return NS_OK;
}

static int read_text(reader *r) {
    if (!next_token(r))
        return refuse(r, NS_E_SIZE, "the text ends before m");
    const int status = parse_m(r);
    return status ? status : read_numbers(r);
}

/* W row by row -> column by column, in place. */
static void transpose(int m, double *a) {
    for (size_t i = 0; i < (size_t)m; i++)
        for (size_t j = i + 1; j < (size_t)m; j++) {
            double *here = a + i + j * (size_t)m, *there = a + j + i * (size_t)m, v = *here;
            *here = *there;
            *there = v;
        }
}

int ns_mlcp_read(const char *text, size_t length, ns_mlcp **out, ns_text_fault *fault) {
    ns_text_fault unread;
    c_locale locale;
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    fault = fault ? fault : &unread;
    memset(fault, 0, sizeof *fault);
    if (!text && length > 0)
        return NS_E_NULL;
    reader r = {.at = text, .end = length ? text + length : text, .now = 1, .line = 1, .fault = fault};
    ns_mlcp *p = calloc(1, sizeof *p);
    int status = p ? enter_c_locale(&locale) : NS_E_MEMORY;
    if (status == NS_OK) {
        status = read_text(&r);
        leave_c_locale(&locale);
    }
    if (status != NS_OK) {
        if (status == NS_E_MEMORY)
            snprintf(fault->cause, sizeof fault->cause, "%s", ns_status_text(status));
        fault->line = status == NS_E_MEMORY ? 0 : fault->line;
        free(r.number);
        free(p);
        return status;
    }
    const size_t m = (size_t)r.m;
    p->m = r.m;
    p->data = r.number; /* all arrays are parts of this block */
    if (m > 0) {
        transpose(r.m, r.number);
        p->W = r.number;
        p->q = r.number + m * m;
        p->l = p->q + m;
        p->u = p->l + m;
    }
    *out = p;
    return NS_OK;
}

void ns_mlcp_discard(ns_mlcp *p) {
    if (p)
        free(p->data);
    free(p);
}

/* --- the writer --- */

typedef struct writer {
    char *text;
    size_t size, length; /* length counts what there would be with enough room */
} writer;

static void put(writer *w, const char *piece) {
    const size_t n = strlen(piece), left = w->length < w->size ? w->size - w->length : 0;
    if (left > 0) {
        const size_t fits = n < left ? n : left - 1;
        memcpy(w->text + w->length, piece, fits);
        w->text[w->length + fits] = '\0';
    }
    w->length += n;
}

/* With the fewest digits that give the same double. */
static void put_number(writer *w, double v) {
    char piece[40];
    for (int n = 15; n <= 17; n++) {
        snprintf(piece, sizeof piece, "%.*g", n, v);
        if (strtod(piece, NULL) == v) /* inf and -inf at once, -0 with its sign */
            break;
    }
    put(w, piece);
}

/* n numbers, stride apart, in one line. */
static void put_line(writer *w, int n, const double *v, size_t stride) {
    for (int i = 0; i < n; i++) {
        if (i > 0)
            put(w, " ");
        put_number(w, v[(size_t)i * stride]);
    }
    put(w, "\n");
}

static int check(const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    return ns_linalg_finite(m * m, p->W) && ns_linalg_finite(m, p->q) ? ns_mlcp_check_bounds(p) : NS_E_NUMBER;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): written through w */
int ns_mlcp_write(const ns_mlcp *p, char *text, size_t size, size_t *length) {
    writer w = {text, size, 0};
    c_locale locale;
    char piece[16];
    if (!p || !length || (!text && size > 0) || (p->m > 0 && (!p->W || !p->q || !p->l || !p->u)))
        return NS_E_NULL;
    if (p->m < 0)
        return NS_E_SIZE;
    int status = check(p);
    status = status ? status : enter_c_locale(&locale);
    if (status != NS_OK)
        return status;
    snprintf(piece, sizeof piece, "%d\n", p->m);
    put(&w, piece);
    for (int i = 0; i < p->m; i++)
        put_line(&w, p->m, p->W + i, (size_t)p->m);
    if (p->m > 0) {
        put_line(&w, p->m, p->q, 1);
        put_line(&w, p->m, p->l, 1);
        put_line(&w, p->m, p->u, 1);
    }
    leave_c_locale(&locale);
    *length = w.length;
    return NS_OK;
}
