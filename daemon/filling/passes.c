/* passes.c - see passes.h
 *
 * A pass is closed when all its tiles (tiles.h) are made; then passes that read
 * it may be opened.  If a job begins with another job's records, these records
 * are its first pass.  It has no tiles: the store is asked for the records.
 * Frames come in batches (passes/passplan.h).  The units of a batch go out when
 * its last pass is closed.  The first pass of the next batch changes the cache
 * that these units read, so that pass is closed only when the units are done;
 * but its tiles go out before that, to workers for which there are no units.
 * In a job with a goal (stages.h) the plan is of one stage, and its last pass
 * is a check pass, whose tiles have sums in place of records.  When that pass
 * is closed either the units follow, or all begins anew with the plan of the
 * next stage.  Passes are numbered on through all stages. */
#include "config.h"

#include "filling/passes.h"

#include "desk/speed.h"
#include "desk/verdict.h"
#include "filling/colours.h"
#include "filling/filled.h"
#include "filling/passes_impl.h"
#include "filling/records.h"
#include "filling/stages.h"
#include "filling/tiles.h"
#include "jobs/progress.h"
#include "machine/rowsum.h"
#include "machine/sums.h"
#include "passes/passcost.h"
#include "proto/ambshare.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* Most bytes of a stage's records.  A pass gets no tiles if the passes that it
 * reads have half of that already; one pass cannot make the other half. */
#define MOST_BYTES SAVED_STAGE_BYTES

_Static_assert(RAD_MOST_PASSES <= MSG_MOST_PASSES, "as in READY");
_Static_assert(RAD_PASS_PARTS == MSG_OPEN_PASSES, "one of each part");

/* --- the plan --- */

static void
drop_records(struct passes *s)
{
    for (uint32_t i = 0; s->closed && i < s->n; i++)
        free(s->closed[i].records);
    s->bytes = 0;
}

void
passes_free(struct passes *s)
{
    if (!s)
        return;
    tiles_drop(s);
    drop_records(s);
    free(s->plan);
    free(s->weight);
    free(s->closed);
    free(s->size);
    free(s);
}

/* Count the frames that are done. */
static void
note_done(struct job *job)
{
    struct passes *s = job->passes;

    while (s->done < job->spec.nframes && job->frames[s->done].pixels_left == 0)
        s->done++;
}

/* Are all frames done whose passes are closed?  Their units read the cache that
 * the next pass to be closed would change. */
static bool
is_due(const struct passes *s)
{
    return s->done >= rad_passes_ready(s->plan, s->open);
}

/* Let the units of frames whose passes are closed go out. */
static void
open_frames(struct job *job)
{
    struct passes *s = job->passes;

    job->filling = s->open < s->n;
    if (s->n > 0 && job->partition) /* a job may end before it has units */
        partition_open(job->partition, rad_passes_ready(s->plan, s->open));
}

/* Close the passes that an earlier life of the coordinator closed. */
static void
take_up_kept(struct coord *c, struct job *job)
{
    struct kept_passes *kept = &job->kept;
    struct passes *s = job->passes;

    for (uint32_t i = s->base; i < kept->n && s->open < s->n && is_due(s);
         i++, s->opened = ++s->open) {
        struct saved_pass *p = &kept->pass[i];
        struct closed *k = &s->closed[s->open];

        if (!s->plan[s->open].check) {
            if (p->len % AMBSHARE_BYTES != 0)
                break;
            k->records = (uint8_t *)p->bytes;
            k->n = (uint32_t)(p->len / AMBSHARE_BYTES);
            if (k->records)
                k->sum = rowsum_hash(k->records, p->len);
            s->bytes += p->len;
            p->bytes = NULL;
        }
        k->counts = p->counts;
        progress_count_tiles(job, &p->counts);
    }
    if (s->open > 0 && stages_reuse(job))
        job->cache.reused = s->closed[0].n;
    if (s->open > 0)
        actions_log(&c->actions, ACT_INFO, "passes kept job=%s passes=%u of=%u",
                    job->hex, s->open, s->n);
    kept_drop(kept);
}

/* Bytes of records of the first n passes, which are closed.  Whether a pass has
 * tiles follows from the passes that it reads, not from all passes that are
 * closed when it is opened: these may be more after a restart. */
static size_t
bytes_of(const struct passes *s, uint32_t n)
{
    size_t bytes = 0;

    for (uint32_t i = 0; i < n; i++)
        if (!s->plan[i].walks)
            bytes += (size_t)s->closed[i].n * AMBSHARE_BYTES;
    return bytes;
}

/* Open the passes that read closed passes alone; false: memory is out. */
static bool
open_passes(struct passes *s)
{
    for (; s->opened < s->n && s->plan[s->opened].reads <= s->open;
         s->opened++) {
        struct rad_pass *pass = &s->plan[s->opened];

        if (!pass->check && bytes_of(s, pass->reads) > MOST_BYTES / 2)
            pass->tiles = 0;
        if (!tiles_open(s, s->opened))
            return false;
    }
    return true;
}

static void close_made(struct coord *c, struct job *job);

void
passes_ask(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct action *a;

    if (!s || s->reuse != REUSE_DUE || job->place != PLACE_OPEN ||
        job_over(job))
        return;
    a = actions_add_job(&c->actions, ACT_LOAD_CACHE, 0, job->id);
    if (a)
        a->sequence = job->sequence;
    s->reuse = REUSE_ASKED;
}

/* Make the plan of the present stage. */
static int
make_plan(struct passes *s, const struct job *job, struct rad_error *err)
{
    struct rad_pass *plan;
    int rc;

    free(s->plan);
    free(s->weight);
    free(s->closed);
    s->weight = NULL;
    s->closed = NULL;
    s->plan = malloc(RAD_MOST_PASSES * sizeof *s->plan);
    if (!s->plan)
        return rad_fail_memory(err);
    rc = stages_plan(job, s->size, s->plan, &s->n, err);
    if (rc < 0)
        return rc;
    plan = realloc(s->plan, (s->n + 1) * sizeof *plan);
    s->plan = plan ? plan : s->plan;
    s->weight = calloc(s->n + 1, sizeof *s->weight);
    s->closed = calloc(s->n + 1, sizeof *s->closed);
    return s->weight && s->closed ? 0 : rad_fail_memory(err);
}

/* Lay out the passes of the present stage; none is closed. */
static int
plan_stage(struct job *job, struct rad_error *err)
{
    struct passes *s = job->passes;
    struct rad_params params;
    int rc = make_plan(s, job, err);

    s->base = job->goal.base;
    s->open = s->opened = 0;
    for (uint32_t i = 0; rc == 0 && i < s->n; i++)
        if (s->plan[i].tiles > MSG_MOST_TILES)
            rc = rad_fail(err, RAD_EDATA,
                          "so many and large frames are too much for "
                          "--ambient=passes: a pass would have %u tiles, at "
                          "most %u are allowed",
                          s->plan[i].tiles, MSG_MOST_TILES);
    if (rc == 0 && s->base + s->n > MSG_MOST_PASSES)
        rc =
            rad_fail(err, RAD_EDATA,
                     "so many frames are too much for a goal: its stages would "
                     "have more than %u passes",
                     MSG_MOST_PASSES);
    rc = rc < 0 ? rc : stages_params(job, &params, err);
    if (rc == 0)
        rad_passcost_weigh(&params, s->plan, s->n, s->weight);
    return rc;
}

/* Note how far the passes are; an open pass counts by its tiles. */
static void
note_progress(struct job *job)
{
    struct passes *s = job->passes;
    double all = 0, done = 0;

    for (uint32_t i = 0; i < s->n; i++) {
        const struct sheet *k = passes_sheet(s, i);

        all += s->weight[i];
        if (i < s->open)
            done += s->weight[i];
        else if (i < s->opened && k->ntiles > 0)
            done += s->weight[i] * (k->ntiles - k->left) / k->ntiles;
    }
    filled_note(job, all > 0 ? done / all : 1, s->open == s->n);
}

/* Make job->passes, with the passes of the present stage; none is closed. */
static int
lay_out(struct job *job, struct rad_error *err)
{
    struct passes *s = job->passes = calloc(1, sizeof *s);
    int rc;

    if (!s || !(s->size = stages_sizes(&job->spec)))
        return rad_fail_memory(err);
    tiles_drop(s);
    rc = plan_stage(job, err);
    if (rc == 0)
        filled_begin(job, s->size);
    return rc;
}

int
passes_begin(struct coord *c, struct job *job, struct rad_error *err)
{
    struct passes *s;
    int rc;

    if (!(job->spec.flags & MSG_JOB_PASSES))
        return 0;
    rc = lay_out(job, err);
    if (rc < 0)
        return rc;
    s = job->passes;
    note_done(job);
    take_up_kept(c, job);
    open_frames(job);
    s->reuse = s->n > 0 && stages_reuse(job) ? REUSE_DUE : REUSE_NONE;
    passes_ask(c, job);
    /* until the first pass has come from the store no pass is opened, for the
     * bytes of its records limit the other passes */
    if (s->reuse != REUSE_NONE && s->open == 0)
        return 0;
    if (!open_passes(s))
        return rad_fail_memory(err);
    close_made(c, job);
    note_progress(job);
    return 0;
}

void
passes_restore(struct job *job)
{
    const struct kept_passes *kept = &job->kept;
    uint64_t rays = job->rays;

    if (lay_out(job, NULL) == 0) {
        struct passes *s = job->passes;

        for (uint32_t i = s->base; i < kept->n && s->open < s->n; i++) {
            s->closed[s->open++].counts = kept->pass[i].counts;
            rays += kept->pass[i].counts.rays;
        }
        s->opened = s->open;
        note_progress(job);
        if (rays > job->rays_seen)
            job->rays_seen = rays;
    }
    passes_free(job->passes);
    job->passes = NULL;
}

bool
passes_open(const struct job *job)
{
    const struct passes *s = job->passes;

    return s && ((s->open < s->n && is_due(s)) || s->reuse != REUSE_NONE);
}

struct passes_state
passes_state(const struct job *job)
{
    const struct passes *s = job->passes;
    struct passes_state out = { 0 };
    const struct sheet *k;

    if (!s)
        return out;
    k = passes_sheet(job->passes, s->open);
    out.open = s->open;
    out.n = s->n;
    out.bytes = s->bytes;
    if (s->opened > s->open && k->ntiles > 0)
        out.made = 1 - (double)k->left / k->ntiles;
    return out;
}

/* --- closing passes --- */

/* Put the records of the first open pass together, in the order of tiles;
 * false: memory is out. */
static bool
gather_records(struct passes *s)
{
    const struct sheet *of = passes_sheet(s, s->open);
    struct closed *k = &s->closed[s->open];
    uint8_t *to;

    for (uint32_t i = 0; i < of->ntiles; i++)
        k->n += of->tile[i].n;
    k->records = to = malloc((size_t)k->n * AMBSHARE_BYTES + 1);
    for (uint32_t i = 0; to && i < of->ntiles; i++) {
        size_t len = (size_t)of->tile[i].n * AMBSHARE_BYTES;

        if (len > 0)
            memcpy(to, of->tile[i].records, len);
        to += len;
    }
    if (!to)
        return false;
    k->sum = rowsum_hash(k->records, (size_t)k->n * AMBSHARE_BYTES);
    return true;
}

/* Have the store keep a closed pass, so that another life of the coordinator
 * goes on from there. */
static void
keep_closed(struct coord *c, const struct job *job, uint32_t pass,
            struct saved_pass saved)
{
    struct action *a;

    if (!c->env.keeps ||
        !(a = actions_add_job(&c->actions, ACT_PUT_PASS, 0, job->id)))
        return;
    saved.bytes = actions_keep(&c->actions, saved.bytes, saved.len);
    a->frame = pass;
    a->pass = actions_keep(&c->actions, &saved, sizeof saved);
}

/* The goal is not reached: drop all records, and begin the next stage. */
static void
begin_stage(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct rad_error err = { 0 };

    tiles_drop(s);
    job->goal.bytes += s->bytes;
    drop_records(s);
    s->reuse = REUSE_NONE; /* only the first stage begins with another job's
                            * records */
    if (plan_stage(job, &err) < 0) {
        verdict_job(c, job, JOB_FAILED, rad_exit_status(err.code), err.what);
        s->n = 0;
        return;
    }
    records_drop(c, job);
    if (!open_passes(s))
        c->actions.failed = true;
    c->stirred = true;
}

/* Close the check pass, whose tiles are all made; false: another stage begins.
 */
static bool
close_check(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct msg_counts counts = s->closed[s->open].counts;
    uint32_t number = passes_number(s);
    const struct sheet *k = passes_sheet(s, s->open);
    struct stage_found all = { .check = counts.rays, .check_s = counts.cpu_s };
    struct rad_refine_sums of;
    uint8_t bytes[STAGES_BYTES];
    bool reached;

    for (uint32_t i = 0; i < k->ntiles; i++) {
        if (sums_unpack(k->tile[i].records, SUMS_BYTES, &of))
            rad_refine_add(&all.sums, &of);
        k->tile[i].n = 0;
    }
    for (uint32_t i = 0; i < s->open; i++) {
        all.rays += s->closed[i].counts.rays;
        all.rays_s += s->closed[i].counts.cpu_s;
    }
    reached = stages_end(c, job, s->n, &all);
    stages_pack(c, job, bytes);
    keep_closed(c, job, number,
                (struct saved_pass){ bytes, sizeof bytes, counts, true });
    if (!reached && !c->actions.failed)
        begin_stage(c, job);
    return reached;
}

static void
close_pass(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;
    struct closed *k = &s->closed[s->open];
    bool checks = s->plan[s->open].check, walks = s->plan[s->open].walks;

    if (checks && !close_check(c, job))
        return;
    if (!gather_records(s)) {
        c->actions.failed = true;
        return;
    }
    if (!checks) /* paths are not kept: a worker can walk them again */
        keep_closed(c, job, passes_number(s),
                    (struct saved_pass){
                        .bytes = k->records,
                        .len = walks ? 0 : (size_t)k->n * AMBSHARE_BYTES,
                        .counts = k->counts });
    colours_close(job, &s->plan[s->open]);
    if (job->spec.flags & MSG_JOB_RECORDS && !walks)
        records_to_users(c, job, s->open);
    actions_log(&c->actions, ACT_DEBUG,
                "pass closed job=%s pass=%u level=%d step=%d tiles=%u "
                "records=%u",
                job->hex, passes_number(s), s->plan[s->open].level,
                s->plan[s->open].step, s->plan[s->open].tiles, k->n);
    kept_note_time(&job->cache, c->now_ms);
    tiles_close(s, s->open++);
    records_tell(c, job);
    open_frames(job);
    if (!open_passes(s))
        c->actions.failed = true;
    c->stirred = true;
}

/* Close open passes, in their order, whose tiles are all made. */
static void
close_made(struct coord *c, struct job *job)
{
    struct passes *s = job->passes;

    while (s->open < s->opened && passes_sheet(s, s->open)->left == 0 &&
           is_due(s) && !c->actions.failed)
        close_pass(c, job);
}

/* Close open passes as close_made() does.  If none_out is set, no unit went out
 * yet: share the units out when the passes of the first frames are closed. */
static void
close_passes(struct coord *c, struct job *job, bool none_out)
{
    close_made(c, job);
    if (none_out && !passes_open(job) && !job->survey)
        speed_share(c, job);
}

/* Are the passes of the first batch of frames not closed yet? */
static bool
is_before_units(const struct passes *s)
{
    return rad_passes_ready(s->plan, s->open) == 0;
}

void
passes_frame_done(struct coord *c, struct job *job)
{
    if (!job->filling || job_over(job))
        return;
    note_done(job);
    close_passes(c, job, is_before_units(job->passes));
    note_progress(job);
    c->stirred = true;
}

static bool
keep_tile(struct coord *c, struct job *job, struct sheet *k, struct tile *t,
          const struct msg_tile_made *m)
{
    struct passes *s = job->passes;
    double took;

    t->records = malloc(m->len + 1);
    if (!t->records) {
        c->actions.failed = true;
        return false;
    }
    if (m->len > 0)
        memcpy(t->records, m->data, m->len);
    t->n = m->count;
    k->waiting -= t->nholders == 0; /* it had been taken from its worker */
    t->made = true;
    s->bytes += m->len;
    took = (double)(c->now_ms - t->out_ms);
    s->took_ms += took;
    s->took_ms2 += took * took;
    k->left--;
    return true;
}

static void
count_tile(struct job *job, uint32_t pass, uint32_t index,
           const struct msg_counts *counts)
{
    msg_counts_add(&job->passes->closed[pass].counts, counts);
    job->parts[index].setbacks = 0;
    job->parts[index].surveyed_rays += counts->rays;
    progress_count_tiles(job, counts);
    progress_see(job);
}

/* Why a TILE_MADE does not fit a pass of the plan; NULL: it does. */
static const char *
tile_fault(const struct job *job, uint32_t pass, const struct msg_tile_made *m)
{
    struct passes *s = job->passes;
    struct rad_refine_sums sums;

    if (pass >= s->opened || m->tile >= passes_sheet(s, pass)->ntiles ||
        s->bytes + m->len > MOST_BYTES ||
        !colours_fit(job, &s->plan[pass], m->tile, m->colours_len))
        return "a TILE_MADE that fits no tile";
    if (!s->plan[pass].check)
        return m->len == (size_t)m->count * AMBSHARE_BYTES
                   ? NULL
                   : "a TILE_MADE whose records have not their size";
    return m->count == 0 && sums_unpack(m->data, m->len, &sums)
               ? NULL
               : "sums of a tile that are no finite numbers";
}

/* Take the records of a tile of an open pass; false: the tile was made before.
 */
static bool
take_tile(struct coord *c, struct job *job, uint32_t pass, uint32_t index,
          const struct msg_tile_made *m)
{
    struct passes *s = job->passes;
    struct sheet *k = passes_sheet(s, pass);
    struct tile *t = &k->tile[m->tile];

    if (tiles_take(k, t, index)) {
        job->parts[index].ntiles[pass % MSG_OPEN_PASSES]--;
        c->roomy = job->parts[index].worker;
    }
    if (t->made)
        return false;
    if (!keep_tile(c, job, k, t, m))
        return true;
    records_feed(c, job, pass, m->tile);
    count_tile(job, pass, index, &m->counts);
    colours_keep(c, job, &s->plan[pass], m);
    close_passes(c, job, is_before_units(s));
    note_progress(job);
    return true;
}

void
passes_made(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_tile_made *m = &msg->tile_made;
    uint32_t index, pass;
    struct job *job = desk_job_of(c, w, m->job, &index);
    const char *fault;

    if (!job || !job->passes)
        return;
    pass = m->pass - job->passes->base;
    if (m->pass >= passes_number(job->passes)) {
        fault = tile_fault(job, pass, m);
        if (fault) {
            verdict_break(c, w->conn, fault);
            return;
        }
        if (take_tile(c, job, pass, index, m))
            return;
    }
    msg_counts_add(&job->parts[index].past.dropped, &m->counts);
}

/* --- records of another job --- */

void
passes_came(struct coord *c, struct job *job, const struct saved_cache *cache)
{
    struct passes *s = job->passes;

    if (!s || s->reuse == REUSE_NONE || cache->status != 0 ||
        cache->len % AMBSHARE_BYTES != 0) {
        free(cache->records);
        if (s && s->reuse != REUSE_NONE)
            verdict_job(c, job, JOB_FAILED,
                        cache->status ? cache->status : EX_DATAERR,
                        cache->status ? cache->text : "no ambient records");
        return;
    }
    s->reuse = REUSE_NONE;
    s->closed[0].records = cache->records;
    s->closed[0].n = (uint32_t)(cache->len / AMBSHARE_BYTES);
    job->cache.reused = s->closed[0].n;
    if (s->open == 0) {
        s->open = s->opened = 1;
        s->bytes = cache->len;
        if (!open_passes(s))
            c->actions.failed = true;
        if (job->spec.flags & MSG_JOB_RECORDS)
            records_to_users(c, job, 0);
    }
    records_came(c, job);
    close_passes(c, job, true);
    c->stirred = true;
}
