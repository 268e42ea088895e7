/* fuzz_keyfile.c - any text as a key file
 *
 * What is taken is written line by line and read again, and must be the same;
 * a key that is added and one that is retired leave the others alone. */
#include "config.h"

#include "net/key/keyfile.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

static void
same(const struct key *a, const struct key *b)
{
    if (a->role != b->role || strcmp(a->name, b->name) != 0 ||
        a->number != b->number || a->retired != b->retired ||
        a->expires != b->expires ||
        memcmp(a->secret, b->secret, KEY_SECRET) != 0)
        abort();
}

static void
round_trip(const struct key *k)
{
    char line[KEY_LINE + 1];
    struct keyfile g;

    key_format(k, line);
    if (keyfile_parse(&g, line, strlen(line), NULL) < 0 || g.n != 1)
        abort();
    same(k, &g.v[0]);
    keyfile_release(&g);
}

static void
change(struct keyfile *f)
{
    size_t n = f->n;
    char id[KEY_ID];

    if (n == 0 || n >= KEY_MOST || f->len > KEY_MAX_FILE - KEY_LINE)
        return;
    key_id(&f->v[0], id);
    if (keyfile_find(f, id) != &f->v[0])
        abort();
    if (keyfile_retire(f, id, NULL) < 0 || f->n != n || !f->v[0].retired)
        abort();
    if (keyfile_add(f, "worker:fuzz", 0, NULL) == 0 && f->n != n + 1)
        abort();
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct keyfile f;

    if (keyfile_parse(&f, (const char *)data, size, NULL) < 0)
        return 0;
    for (size_t i = 0; i < f.n; i++)
        round_trip(&f.v[i]);
    change(&f);
    keyfile_release(&f);
    return 0;
}
