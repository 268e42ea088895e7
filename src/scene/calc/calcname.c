/* calcname.c - names of functions and variables, and contexts of names
 *
 * A reference is bound when it is read: to the symbol of its own context if
 * there is one by then, else to the global symbol, else to a library function,
 * else to a new symbol of the context, which a later definition may fill. */
#include "config.h"

#include "scene/calc/calcimpl.h"
#include "base/list.h"
#include "base/text.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define MAX_CONTEXT 600 /* bytes of a context's name */

static int
no_memory(struct rad_error *err)
{
    return rad_fail(err, RAD_ENOMEM, "out of memory for functions");
}

static int32_t *
find_slot(const struct rad_calc *c, const char *name, uint64_t hash)
{
    int32_t mask = c->nslot - 1, i = (int32_t)(hash & (uint64_t)mask);

    for (;; i = (i + 1) & mask) {
        const struct symbol *s = &c->symbol[c->slot[i]];

        if (c->slot[i] < 0 || (s->hash == hash && strcmp(s->name, name) == 0))
            return &c->slot[i];
    }
}

static int32_t
lookup(const struct rad_calc *c, const char *name)
{
    return c->nslot ? *find_slot(c, name, rad_text_hash(name)) : -1;
}

static int
grow_slots(struct rad_calc *c, struct rad_error *err)
{
    int32_t n = c->nslot ? 2 * c->nslot : 256;
    int32_t *more = malloc((size_t)n * sizeof *more);

    if (!more)
        return no_memory(err);
    free(c->slot);
    c->slot = more;
    c->nslot = n;
    memset(more, 0xff, (size_t)n * sizeof *more);
    for (int32_t i = 0; i < c->nsymbol; i++)
        *find_slot(c, c->symbol[i].name, c->symbol[i].hash) = i;
    return 0;
}

static int
find_library(const char *name)
{
    for (int i = 0; i < rad_calc_nlibrary; i++)
        if (strcmp(rad_calc_library[i].name, name) == 0)
            return i;
    return -1;
}

static int32_t
insert(struct rad_calc *c, const char *name, struct rad_error *err)
{
    struct symbol s = { .hash = rad_text_hash(name),
                        .code = -1,
                        .channel = -1 };

    if (c->nsymbol >= RAD_MAX_CALC_CODE)
        return rad_fail(err, RAD_EDATA, "functions of too many names");
    if (2 * c->nsymbol >= c->nslot && grow_slots(c, err))
        return RAD_ENOMEM;
    s.name = rad_arena_strndup(&c->arena, name, strlen(name));
    if (!s.name || !rad_list_grow(&c->symbol, (size_t)c->nsymbol, sizeof s))
        return no_memory(err);
    s.library = find_library(name);
    s.kind = s.library >= 0 ? SYM_LIBRARY : SYM_UNDEFINED;
    *find_slot(c, name, s.hash) = c->nsymbol;
    c->symbol[c->nsymbol] = s;
    return c->nsymbol++;
}

/* A context may have several levels, `a`b.  A name is looked for with all of
 * them, then without the first, and so on. */
int32_t
rad_calc_symbol(struct rad_calc *c, const char *context, const char *name,
                bool defined, struct rad_error *err)
{
    char full[MAX_CONTEXT + 256];
    size_t n = strlen(name);
    bool own = n > 0 && name[0] == '`', global = n > 1 && name[n - 1] == '`';
    const char *level = context;
    int32_t i;

    name += own;
    n -= own;
    if (global)
        level = "";
    for (;; level += strcspn(level + 1, "`") + 1) {
        snprintf(full, sizeof full, "%.*s%s", (int)(global ? n - 1 : n), name,
                 level);
        i = lookup(c, full);
        if (i >= 0 || defined || own || global || !*level)
            break;
    }
    if (i >= 0)
        return i;
    if (!defined && !own && find_library(full) >= 0)
        return insert(c, full, err);
    snprintf(full, sizeof full, "%.*s%s", (int)(global ? n - 1 : n), name,
             global ? "" : context);
    return insert(c, full, err);
}

int
rad_calc_context(struct rad_calc *c, const char *file, struct rad_error *err)
{
    char name[MAX_CONTEXT + 1] = "";
    size_t n = strlen(file), used = 0;

    if (n > 4 && strcasecmp(file + n - 4, ".cal") == 0)
        n -= 4;
    if (strcmp(file, ".") != 0 && n > 0)
        name[used++] = '`';
    for (size_t i = file[0] == '`'; used > 0 && i < n; i++) {
        if (used == MAX_CONTEXT)
            return rad_fail(err, RAD_EDATA, "name of function file too long");
        name[used++] =
            isalnum((unsigned char)file[i]) || file[i] == '.' || file[i] == '`'
                ? file[i]
                : '_';
    }
    while (used > 0 && name[used - 1] == '`')
        used--;
    name[used] = '\0';
    for (int32_t i = 0; i < c->ncontext; i++)
        if (strcmp(c->context[i].name, name) == 0)
            return i;
    if (!rad_list_grow(&c->context, (size_t)c->ncontext, sizeof *c->context))
        return no_memory(err);
    c->context[c->ncontext].loaded = false;
    c->context[c->ncontext].name = rad_arena_strndup(&c->arena, name, used);
    return c->context[c->ncontext].name ? c->ncontext++ : no_memory(err);
}

int
rad_calc_loaded(const struct rad_calc *c, int context)
{
    return c->context[context].loaded;
}
