/* rif.c - see rif.h */
#include "config.h"

#include "rif/rif.h"

#include "base/number.h"
#include "base/text.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum kind {
    KIND_TEXT,  /* one value, may be in quotes */
    KIND_ONE,   /* one value of several words */
    KIND_WORDS, /* values are added up */
    KIND_LEVEL, /* low, medium or high */
    KIND_BOOL,
    KIND_INT,
    KIND_REAL,
    KIND_EACH /* each value counts by itself */
};

static const struct {
    const char *name;
    size_t shortest; /* least letters of an abbreviated name */
    enum kind kind;
} table[RIF_VARS] = {
    { "AMBFILE", 3, KIND_TEXT },    { "DETAIL", 3, KIND_LEVEL },
    { "EXPOSURE", 3, KIND_REAL },   { "EYESEP", 3, KIND_REAL },
    { "illum", 3, KIND_WORDS },     { "INDIRECT", 3, KIND_INT },
    { "materials", 3, KIND_WORDS }, { "mkillum", 3, KIND_WORDS },
    { "mkpmap", 3, KIND_WORDS },    { "objects", 3, KIND_WORDS },
    { "oconv", 3, KIND_WORDS },     { "OCTREE", 3, KIND_TEXT },
    { "OPTFILE", 3, KIND_TEXT },    { "PCMAP", 2, KIND_TEXT },
    { "PENUMBRAS", 3, KIND_BOOL },  { "pfilt", 2, KIND_WORDS },
    { "PGMAP", 2, KIND_TEXT },      { "PICTURE", 3, KIND_TEXT },
    { "QUALITY", 3, KIND_LEVEL },   { "RAWFILE", 3, KIND_TEXT },
    { "render", 3, KIND_WORDS },    { "REPORT", 3, KIND_ONE },
    { "RESOLUTION", 3, KIND_ONE },  { "rpict", 3, KIND_WORDS },
    { "rvu", 3, KIND_WORDS },       { "scene", 3, KIND_WORDS },
    { "UP", 2, KIND_ONE },          { "VARIABILITY", 3, KIND_LEVEL },
    { "view", 2, KIND_EACH },       { "ZFILE", 2, KIND_TEXT },
    { "ZONE", 2, KIND_ONE },
};

const char *
rif_variable(enum rif_var v)
{
    return table[v].name;
}

/* The variable whose name begins with these letters; -1: none. */
static int
find(const char *name, size_t len)
{
    for (int v = 0; v < RIF_VARS; v++)
        if (len >= table[v].shortest && strncmp(name, table[v].name, len) == 0)
            return v;
    return -1;
}

/* Add a value, text[len], without blanks at its ends. */
static int
enter(struct rif *r, enum rif_var v, const char *text, size_t len, int line,
      struct rad_error *err)
{
    struct rif_value *value = rad_arena_calloc(&r->arena, 1, sizeof *value);

    if (r->nvalues >= RIF_MAX_VALUES)
        return rad_fail(err, RAD_EDATA, "more than %d assignments",
                        RIF_MAX_VALUES);
    if (!value || !(value->text = rad_arena_strndup(&r->arena, text, len)))
        return rad_fail_memory(err);
    value->line = line;
    if (r->last[v])
        r->last[v]->next = value;
    else
        r->first[v] = value;
    r->last[v] = value;
    r->nvalues++;
    return 0;
}

/* Take an assignment, from which escapes and comment were removed.  One without
 * a value is ignored. */
static int
assign(struct rif *r, const char *s, size_t len, int line,
       struct rad_error *err)
{
    const char *end = s + len, *name;
    size_t n;
    int v;

    while (s < end && isspace((unsigned char)*s))
        s++;
    name = s;
    while (s < end && *s != '=' && !isspace((unsigned char)*s))
        s++;
    n = (size_t)(s - name);
    while (s < end && (*s == '=' || isspace((unsigned char)*s)))
        s++;
    while (end > s && isspace((unsigned char)end[-1]))
        end--;
    if (n == 0 || s == end)
        return 0;
    v = find(name, n);
    if (v < 0)
        return rad_fail(err, RAD_EDATA, "unknown variable '%.*s'",
                        n < 40 ? (int)n : 40, name);
    return enter(r, (enum rif_var)v, s, (size_t)(end - s), line, err);
}

/* Copy one line into `out`, without escapes and comment.  Returns the beginning
 * of the next line, and adds all newlines on the way to *line. */
static const char *
take_line(const char *s, const char *end, char *out, size_t *len, int *line)
{
    bool comment = false;
    size_t n = 0;

    while (s < end && *s != '\n') {
        char c = *s++;

        if (c == '\\' && s < end) {
            if (*s == '\r' && s + 1 < end && s[1] == '\n')
                s++;
            *line += *s == '\n';
            c = *s == '\n' ? ' ' : *s;
            s++;
        } else if (c == '#') {
            comment = true;
        }
        if (!comment)
            out[n++] = c;
    }
    *line += s < end;
    *len = n;
    return s < end ? s + 1 : s;
}

int
rif_parse(struct rif *r, const char *name, const char *text, size_t len,
          struct rad_error *err)
{
    const char *end = text + len;
    char *buf = malloc(len + 1);
    int line = 1, rc = 0;

    memset(r, 0, sizeof *r);
    rad_arena_init(&r->arena);
    r->name = name;
    if (!buf)
        return rad_fail_memory(err);
    if (len > RIF_MAX_BYTES || memchr(text, '\0', len)) {
        rad_error_where(err, "%s", name);
        rc = rad_fail(err, RAD_EDATA, "no text, or more than %d bytes",
                      RIF_MAX_BYTES);
    }
    text += rad_text_mark(text, len);
    while (rc == 0 && text < end) {
        int begun = line;
        size_t n;

        text = take_line(text, end, buf, &n, &line);
        rc = assign(r, buf, n, begun, err);
        if (rc < 0)
            rad_error_where(err, "%s:%d", name, begun);
    }
    free(buf);
    return rc;
}

void
rif_release(struct rif *r)
{
    rad_arena_release(&r->arena);
    memset(r, 0, sizeof *r);
}

int
rif_assign(struct rif *r, const char *assignment, struct rad_error *err)
{
    struct rad_error why = { 0 };
    const char *equals = strchr(assignment, '=');

    if (!equals || equals[strspn(equals, "= \t\n")] == '\0')
        return rad_fail(err, RAD_EUSAGE,
                        "'%.60s' after '%s': expected VARIABLE=value",
                        assignment, r->name);
    if (assign(r, assignment, strlen(assignment), 0, &why) == 0)
        return 0;
    return rad_fail(err, why.code == RAD_EDATA ? RAD_EUSAGE : why.code,
                    "'%.60s': %s", assignment, why.what);
}

int
rif_fail(const struct rif *r, enum rif_var v, struct rad_error *err,
         const char *what)
{
    const struct rif_value *value = r->last[v];

    if (value && value->line > 0)
        rad_error_where(err, "%s:%d", r->name, value->line);
    else
        rad_error_where(err, "%s", r->name);
    return rad_fail(err, RAD_EDATA, "%s: %s", table[v].name, what);
}

/* Is text, which is not empty, the word or its beginning, in any case? */
static bool
begins(const char *word, const char *text)
{
    for (; *text; text++, word++)
        if (toupper((unsigned char)*text) != *word)
            return false;
    return true;
}

/* What is wrong with a value of this kind; NULL: nothing. */
static const char *
fault(enum kind kind, const char *text)
{
    double real;
    int whole;

    switch (kind) {
    case KIND_LEVEL:
        return begins("LOW", text) || begins("MEDIUM", text) ||
                       begins("HIGH", text)
                   ? NULL
                   : "expected low, medium or high";
    case KIND_BOOL:
        return begins("TRUE", text) || begins("FALSE", text)
                   ? NULL
                   : "expected true or false";
    case KIND_INT:
        return rad_parse_int(text, &whole) ? NULL : "expected a whole number";
    case KIND_REAL:
        return rad_parse_real(text, &real) ? NULL : "expected a number";
    default:
        return NULL;
    }
}

int
rif_check(const struct rif *r, struct rad_error *err)
{
    for (int v = 0; v < RIF_VARS; v++) {
        const char *what =
            r->last[v] ? fault(table[v].kind, r->last[v]->text) : NULL;
        char text[200];

        if (!what)
            continue;
        snprintf(text, sizeof text, "'%.60s': %s", r->last[v]->text, what);
        return rif_fail(r, (enum rif_var)v, err, text);
    }
    return 0;
}

const char *
rif_text(struct rif *r, enum rif_var v)
{
    const char *text = r->last[v] ? r->last[v]->text : NULL;
    size_t n = text ? strlen(text) : 0;

    if (n >= 2 && (text[0] == '"' || text[0] == '\'') && text[n - 1] == text[0])
        text = rad_arena_strndup(&r->arena, text + 1, n - 2);
    return text;
}

char
rif_letter(const struct rif *r, enum rif_var v, char none)
{
    return r->last[v] ? (char)toupper((unsigned char)r->last[v]->text[0])
                      : none;
}

/* --- words --- */

/* Copy the word at *s, without quotes, to *out, which moves behind its NUL;
 * false: a quote has no end. */
static bool
take_word(const char **s, char **out)
{
    const char *p = *s;
    char *to = *out, quote = '\0';

    for (; *p && (quote || !isspace((unsigned char)*p)); p++) {
        if (quote ? *p == quote : *p == '\'' || *p == '"')
            quote = quote ? '\0' : *p;
        else if (*p == '\\' && quote != '\'' && p[1])
            *to++ = *++p;
        else
            *to++ = *p;
    }
    *to++ = '\0';
    *out = to;
    *s = p;
    return !quote;
}

/* Add the words of text to a list of *n words that has room for them. */
static int
add_words(struct rif *r, char **list, int *n, const char *text,
          struct rad_error *err)
{
    /* enough, for a word's NUL takes the place of the blank after it */
    char *to = rad_arena_alloc(&r->arena, strlen(text) + 1);

    if (!to)
        return rad_fail_memory(err);
    for (;;) {
        while (isspace((unsigned char)*text))
            text++;
        if (*text == '\0')
            return 0;
        list[(*n)++] = to;
        if (!take_word(&text, &to))
            return rad_fail(err, RAD_EDATA, "a quote without its end");
    }
}

int
rif_split(struct rif *r, const char *text, char ***words, struct rad_error *err)
{
    int n = 0, rc;

    *words = rad_arena_calloc(&r->arena, strlen(text) / 2 + 2, sizeof **words);
    if (!*words)
        return rad_fail_memory(err);
    rc = add_words(r, *words, &n, text, err);
    return rc < 0 ? rc : n;
}

int
rif_words(struct rif *r, enum rif_var v, char ***words, struct rad_error *err)
{
    size_t room = 1;
    int n = 0;

    for (const struct rif_value *i = r->first[v]; i; i = i->next)
        room += strlen(i->text) / 2 + 1;
    *words = rad_arena_calloc(&r->arena, room, sizeof **words);
    if (!*words)
        return rad_fail_memory(err);
    for (const struct rif_value *i = r->first[v]; i; i = i->next) {
        int rc = add_words(r, *words, &n, i->text, err);

        if (rc < 0) {
            rad_error_where(err, "%s:%d", r->name, i->line);
            return rc;
        }
    }
    return n;
}
