/* duplicate.c - see duplicate.h
 *
 * A pixel of an exact job (job.exact) is a function of scene and options.  So
 * two attempts at a unit give the same bytes, on machines that compute the same
 * bits.  Where the bytes differ a machine is broken, or radd is: the log tells,
 * and the rows that came first stay.  A hash of each row that counts is kept,
 * 8 bytes a row. */
#include "config.h"

#include "desk/duplicate.h"

#include "jobs/job.h"
#include "machine/rowsum.h"

#include "image/hdr.h"

#include <stdlib.h>
#include <string.h>

/* Bytes of the row at offset `at`; the code of coded rows was checked before.
 */
static size_t
row_bytes(const struct msg_result *m, size_t at)
{
    if (m->channels == 1)
        return rad_hdr_row_bytes(m->pixels + at, m->len - at, (int)m->width);
    return (size_t)m->width * m->channels * 4;
}

void
duplicate_keep(struct job *job, uint32_t index, const struct msg_result *m,
               uint32_t height)
{
    struct job_unit *u = &job->units[m->unit];
    size_t at = 0;

    if (!job->exact)
        return;
    if (!u->hashes.row) {
        u->hashes.row = calloc(height, sizeof *u->hashes.row);
        u->hashes.n = u->hashes.row ? height : 0; /* 0: nothing is compared */
    }
    u->hashes.fingerprint = job->parts[index].fingerprint;
    for (uint32_t i = 0; i < m->rows && m->row + i < u->hashes.n; i++) {
        size_t n = row_bytes(m, at);

        u->hashes.row[m->row + i] = rowsum_hash(m->pixels + at, n);
        at += n;
    }
}

void
duplicate_check(struct coord *c, struct job *job, uint32_t index,
                const struct msg_result *m)
{
    struct job_unit *u = &job->units[m->unit];
    size_t at = 0, n;

    /* rows of an attempt of an earlier life may be of another unit: that life
     * may have given this number to a unit of which nothing was kept */
    if (m->attempt < unit_first_attempt(job) ||
        u->hashes.fingerprint != job->parts[index].fingerprint)
        return;
    for (uint32_t i = 0; i < m->rows && m->row + i < u->hashes.n;
         i++, at += n) {
        uint64_t kept = u->hashes.row[m->row + i];

        n = row_bytes(m, at);
        if (kept == 0 || kept == rowsum_hash(m->pixels + at, n))
            continue;
        actions_log(&c->actions, ACT_ERR,
                    "duplicate differs job=%s unit=%u row=%u worker=%s "
                    "first=%s",
                    job->hex, m->unit, m->row + i, job->parts[index].name,
                    job->parts[u->part].name);
        return;
    }
}

void
duplicate_forget(struct job_unit *u)
{
    free(u->hashes.row);
    u->hashes.row = NULL;
    u->hashes.n = 0;
}
