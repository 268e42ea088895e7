/* strict.c - see strict.h; strict_state.h names the other files */
#include "config.h"

#include "strict/strict.h"

#include "strict/strict_edge.h"
#include "strict/strict_facts.h"
#include "strict/strict_out.h"
#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

int
strict_error(const struct strict *s)
{
    return s->error;
}

void
strict_free(struct strict *s)
{
    if (!s)
        return;
    while (s->units) {
        struct strict_unit *u = s->units;

        s->units = u->next;
        strict_unit_free(u);
    }
    edge_release(s);
    out_release(s);
    facts_release(s);
    free(s->frames);
    free(s);
}

struct strict *
strict_new(const struct rad_quincunx *frames, uint32_t nframes, bool painted,
           const uint8_t job[MSG_JOB])
{
    struct strict *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    s->early_end = &s->early;
    memcpy(s->job, job, MSG_JOB);
    s->painted = painted;
    s->frames = calloc(nframes + 1, sizeof *s->frames);
    if (!s->frames) {
        strict_free(s);
        return NULL;
    }
    s->nframes = nframes;
    for (uint32_t i = 0; i < nframes; i++) {
        s->frames[i].q = frames[i];
        s->frames[i].ndensity = rad_quincunx_ndensity(&frames[i]);
        s->frames[i].nlines = rad_quincunx_nbases(&frames[i]);
    }
    return s;
}
