/* calcmemo.c - expressions that were compiled before are not compiled again
 *
 * Converters make meshes in which each of ten thousand faces has a texture of
 * its own, all with the same three expressions; only the real arguments differ,
 * which code reads when it runs.  When a file is read, names may change their
 * meaning, and all expressions are compiled anew. */
#include "config.h"

#include "scene/calc/calcimpl.h"
#include "base/text.h"

#include <string.h>

struct known {
    struct known *next; /* in its slot */
    uint64_t hash;
    int context;
    unsigned offer;
    const char *text;
    struct rad_calc_compiled is;
};

static struct known **
slot_of(struct rad_calc *c, uint64_t hash)
{
    return &c->known[hash % RAD_CALC_KNOWN_SLOTS];
}

static const struct known *
find(struct rad_calc *c, uint64_t hash, int context, const char *text)
{
    const struct known *k = *slot_of(c, hash);

    while (k && (k->hash != hash || k->context != context ||
                 k->offer != c->offer || strcmp(k->text, text) != 0))
        k = k->next;
    return k;
}

/* If memory is out, the expression is compiled again next time. */
static void
keep(struct rad_calc *c, uint64_t hash, int context, const char *text,
     const struct rad_calc_compiled *is)
{
    struct known *k = rad_arena_alloc(&c->arena, sizeof *k);
    char *copy = rad_arena_strndup(&c->arena, text, strlen(text));

    if (!k || !copy)
        return;
    *k = (struct known){ .next = *slot_of(c, hash),
                         .hash = hash,
                         .context = context,
                         .offer = c->offer,
                         .text = copy,
                         .is = *is };
    *slot_of(c, hash) = k;
}

void
rad_calc_forget(struct rad_calc *c)
{
    memset(c->known, 0, sizeof c->known);
}

int
rad_calc_compile(struct rad_calc *c, int context, const char *text,
                 struct rad_calc_compiled *out, struct rad_error *err)
{
    uint64_t hash = rad_text_hash(text) ^ ((uint64_t)context << 8 | c->offer);
    const struct known *k = find(c, hash, context, text);

    if (k) {
        *out = k->is;
        return 0;
    }
    out->code = rad_calc_expression(c, context, text, err);
    if (out->code < 0)
        return out->code;
    rad_calc_needs(c, out->code, &out->need);
    out->number = 0;
    out->is_number = rad_calc_number(c, out->code, &out->number);
    out->channels = rad_calc_channels(c, out->code);
    keep(c, hash, context, text, out);
    return 0;
}
