/* kept.c - see kept.h */
#include "config.h"

#include "jobs/kept.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

bool
kept_copy(struct kept_passes *k, const struct saved_job *s)
{
    k->pass = calloc(s->npasses + 1, sizeof *k->pass);
    if (!k->pass)
        return false;
    for (; k->n < s->npasses; k->n++) {
        const struct saved_pass *from = &s->passes[k->n];
        uint8_t *bytes = from->bytes ? malloc(from->len + 1) : NULL;

        if (!bytes && from->bytes)
            return false;
        if (bytes && from->len > 0)
            memcpy(bytes, from->bytes, from->len);
        k->pass[k->n] = *from;
        k->pass[k->n].bytes = bytes;
    }
    return true;
}

void
kept_cut(struct kept_passes *k, uint32_t n)
{
    while (k->n > n)
        free((void *)k->pass[--k->n].bytes);
}

void
kept_drop(struct kept_passes *k)
{
    kept_cut(k, 0);
    free(k->pass);
    *k = (struct kept_passes){ 0 };
}

void
kept_note_time(struct kept_cache *k, uint64_t now_ms)
{
    if (rad_list_grow(&k->closed_ms, k->nclosed, sizeof *k->closed_ms))
        k->closed_ms[k->nclosed++] = now_ms;
}

void
kept_forget_times(struct kept_cache *k)
{
    free(k->closed_ms);
    k->closed_ms = NULL;
    k->nclosed = 0;
}
