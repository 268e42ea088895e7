/* listing.c - see listing.h */
#include "config.h"

#include "front/listing.h"

#include "front/report.h"
#include "jobs/job.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A row of the list of jobs: a job, or the record of a forgotten one. */
struct job_row {
    uint64_t sequence;
    const struct job *job; /* NULL: the row is of *gone */
    const struct saved_gone *gone;
};

/* Rows of one page in their order: jobs or workers. */
struct page {
    const struct msg_page *ask;
    struct report_share *shares; /* of workers */
    uint32_t most, n;            /* n: rows so far, at most `most` */
    bool more;                   /* there are further rows after the last */
    union {
        struct job_row jobs[LISTING_ROWS];
        const struct coord_worker *workers[LISTING_ROWS];
    } row;
};

/* --- which rows --- */

static bool
is_in(const struct job *job, const char *state)
{
    if (strcmp(state, "open") == 0)
        return !job_over(job);
    if (strcmp(state, "over") == 0)
        return job_over(job);
    return state[0] == '\0' || strcmp(state, job_is(job)) == 0;
}

static bool
wants_job(const struct msg_page *m, const char *owner, const struct job *job)
{
    return (m->cursor == 0 || job->sequence < m->cursor) &&
           (!m->mine || strcmp(job->owner, owner) == 0) &&
           (m->user[0] == '\0' || strcmp(job->owner, m->user) == 0) &&
           is_in(job, m->state);
}

static bool
wants_gone(const struct msg_page *m, const char *owner,
           const struct saved_gone *g)
{
    return (m->cursor == 0 || g->sequence < m->cursor) &&
           (!m->mine || strcmp(g->owner, owner) == 0) &&
           (m->user[0] == '\0' || strcmp(g->owner, m->user) == 0) &&
           strcmp(m->state, "forgotten") == 0; /* only if asked for */
}

/* Insert a job into the page, newest first.  Jobs of equal priority come oldest
 * first, so each may move all rows by one place: no more than a page. */
static void
put_job(struct page *p, const struct job_row *row)
{
    uint32_t i = p->n;

    if (p->n == p->most) {
        p->more = true;
        if (p->row.jobs[p->n - 1].sequence > row->sequence)
            return;
        i--;
    } else {
        p->n++;
    }
    while (i > 0 && p->row.jobs[i - 1].sequence < row->sequence) {
        p->row.jobs[i] = p->row.jobs[i - 1];
        i--;
    }
    p->row.jobs[i] = *row;
}

static void
find_jobs(const struct coord *c, struct page *p, const char *owner)
{
    for (size_t i = c->njobs; i-- > 0;) {
        const struct job *job = c->jobs[i];

        if (wants_job(p->ask, owner, job))
            put_job(p, &(struct job_row){ job->sequence, job, NULL });
    }
    for (size_t i = c->ngones; i-- > 0;) {
        const struct saved_gone *g = &c->gones[i];

        if (wants_gone(p->ask, owner, g))
            put_job(p, &(struct job_row){ g->sequence, NULL, g });
    }
}

static void
find_workers(const struct coord *c, struct page *p)
{
    const struct msg_page *m = p->ask;

    for (const struct coord_worker *w = c->workers; w && !p->more;
         w = w->next) {
        if (w->id < m->cursor || w->forgotten ||
            (m->state[0] &&
             strcmp(m->state, report_worker_state(w, p->shares)) != 0))
            continue;
        if (p->n == p->most)
            p->more = true;
        else
            p->row.workers[p->n++] = w;
    }
}

/* --- their text --- */

static char *
row_text(const struct coord *c, const struct page *p, uint32_t i)
{
    json_t *row;
    char *text;

    if (p->ask->what != MSG_ROWS_JOBS)
        row = report_worker(c, p->row.workers[i], p->shares);
    else if (p->row.jobs[i].job)
        row = report_job(c, p->row.jobs[i].job, MSG_MAX_LABEL);
    else
        row = report_gone(p->row.jobs[i].gone);
    text = json_dumps(row, JSON_COMPACT | JSON_REAL_PRECISION(9));
    json_decref(row);
    return text;
}

/* The cursor for the rows after row i. */
static uint64_t
cursor_of(const struct page *p, uint32_t i)
{
    return p->ask->what == MSG_ROWS_JOBS ? p->row.jobs[i].sequence
                                         : p->row.workers[i]->id + UINT64_C(1);
}

static char *
page_text(const struct coord *c, const struct page *p)
{
    char *all = NULL, *text;
    size_t size;
    uint32_t i = 0;
    FILE *out = open_memstream(&all, &size);

    if (!out)
        return NULL;
    fputs("{\"rows\":[", out);
    for (; i < p->n && ftell(out) < LISTING_BYTES; i++) {
        text = row_text(c, p, i);
        if (!text) {
            fclose(out);
            free(all);
            return NULL;
        }
        fprintf(out, "%s%s", i > 0 ? ",\n" : "", text);
        free(text);
    }
    fprintf(out, "],\"next\":%" PRIu64 "}",
            i > 0 && (i < p->n || p->more) ? cursor_of(p, i - 1) : 0);
    if (fclose(out) == 0)
        return all;
    free(all);
    return NULL;
}

char *
listing_page(const struct coord *c, const struct msg_page *m, const char *owner)
{
    struct page p = { .ask = m, .most = LISTING_ROWS };
    char *text = NULL;

    if (m->most > 0 && m->most < p.most)
        p.most = m->most;
    if (m->what == MSG_ROWS_JOBS)
        find_jobs(c, &p, owner);
    else if ((p.shares = report_shares(c)) != NULL)
        find_workers(c, &p);
    if (m->what == MSG_ROWS_JOBS || p.shares)
        text = page_text(c, &p);
    free(p.shares);
    return text;
}
