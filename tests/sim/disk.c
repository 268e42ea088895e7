/* disk.c - the coordinator's disk, played, and the coordinator's deaths
 *
 * Entries are written in their order, some time later.  When the coordinator
 * dies those that are not written are lost, and a new coordinator begins with
 * the rest. */
#include "config.h"

#include "cluster.h"

#include "image/hdr.h"
#include "desk/desk.h"
#include "front/coord.h"
#include "registry/recover.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One task of the disk. */
struct entry {
    struct action_rows rows;
    struct msg_counts counts;
    struct saved_unit unit;
    char worker[16];
    uint64_t conn, sequence;
    uint8_t from[MSG_JOB]; /* the job whose cache this one begins with */
    uint32_t request, frame;
    uint32_t nbottom;
    size_t nline;
    int state;
    struct saved_job job;
    char text[MSG_MAX_TEXT + 1];
    size_t len;
    uint8_t bytes[]; /* bottom, line and pixels; or statistics */
};

typedef void entry_fn(struct sim *s, struct sim_job *job,
                      const struct entry *e);

static void
write_entry(void *net, struct event *e)
{
    struct sim *s = sim_of(net);
    entry_fn *fn;

    if ((unsigned)e->k != s->lives)
        return; /* the coordinator died before it was written */
    memcpy(&fn, &e->n, sizeof fn);
    fn(s, e->node < 0 ? NULL : &s->job[e->node],
       (const struct entry *)e->bytes);
    sim_coord_actions(s);
}

/* Add an entry with n more bytes to the disk's queue; fn will write it. */
static struct entry *
later(struct sim *s, int job, size_t n, entry_fn *fn)
{
    struct event *e;

    /* entries keep their order, so a delay delays all that follow */
    s->disk_ms += net_random(&s->net, 8);
    if (s->disk_ms < s->net.now_ms)
        s->disk_ms = s->net.now_ms;
    e = net_later(&s->net, (unsigned)(s->disk_ms - s->net.now_ms), write_entry);
    e->node = job;
    e->k = (int)s->lives;
    memcpy(&e->n, &fn, sizeof fn);
    e->bytes = calloc(1, sizeof(struct entry) + n);
    SIM_CHECK(&s->net, e->bytes != NULL);
    return (struct entry *)e->bytes;
}

/* --- entries that are written --- */

/* Make all records of the other job's last stage the first pass of this job. */
static void
begin_with(struct sim *s, struct sim_kept *k, const struct sim_kept *from)
{
    uint8_t *bytes;
    size_t n = 0;

    SIM_CHECK(&s->net, from->cached);
    for (uint32_t i = from->keep.first; i < from->keep.end; i++)
        n += from->pass[i].len;
    bytes = malloc(n + 1);
    SIM_CHECK(&s->net, bytes != NULL);
    for (uint32_t i = 0; i < k->npasses; i++) /* of an earlier try */
        free((void *)k->pass[i].bytes);
    k->npasses = 1;
    k->pass[0] = (struct saved_pass){ .bytes = bytes, .len = n };
    for (uint32_t i = from->keep.first; i < from->keep.end; i++) {
        memcpy(bytes, from->pass[i].bytes, from->pass[i].len);
        bytes += from->pass[i].len;
    }
}

static void
put_opened(struct sim *s, struct sim_job *job, const struct entry *e)
{
    job->kept.opened = true;
    job->kept.job = e->job;
    if (e->job.spec.flags & MSG_JOB_REUSE)
        begin_with(s, &job->kept, &s->job[sim_find_job(s, e->from)].kept);
    coord_job_opened(s->coord, s->net.now_ms, job->id, e->sequence, 0, NULL);
}

static void
put_state(struct sim *s, struct sim_job *job, const struct entry *e)
{
    (void)s;
    job->kept.job.state = (uint8_t)e->state;
    job->kept.job.spec.priority = e->job.spec.priority;
}

static void
put_end(struct sim *s, struct sim_job *job, const struct entry *e)
{
    struct sim_kept *k = &job->kept;

    k->job = e->job;
    snprintf(k->text, sizeof k->text, "%s", e->text);
    free(k->stats);
    k->stats = calloc(1, e->len + 1);
    SIM_CHECK(&s->net, k->stats != NULL);
    memcpy(k->stats, e->bytes, e->len);
    k->cached = e->job.cache_bytes > 0;
    k->keep = e->job.keep;
    SIM_CHECK(&s->net, !k->cached || (k->keep.all == k->npasses &&
                                      k->keep.first < k->keep.end &&
                                      k->keep.end <= k->keep.all));
    coord_job_filed(s->coord, s->net.now_ms, job->id, e->sequence, e->len,
                    e->job.cache_bytes);
}

static void
put_loaded(struct sim *s, struct sim_job *job, const struct entry *e)
{
    const struct saved_pass *first = &job->kept.pass[0];
    struct saved_cache cache = { .records = malloc(first->len + 1),
                                 .len = first->len };

    SIM_CHECK(&s->net, cache.records && job->kept.npasses > 0);
    memcpy(cache.records, first->bytes, first->len);
    coord_cache_came(s->coord, s->net.now_ms, job->id, e->sequence, &cache);
}

static void
put_pass(struct sim *s, struct sim_job *job, const struct entry *e)
{
    struct sim_kept *k = &job->kept;
    bool room = job->spec.flags & MSG_JOB_SCENE || job->spec.error_ppm > 0 ||
                !net_chance(&s->net, 20);
    uint8_t *bytes;

    if (e->frame != k->npasses || !room)
        return;
    bytes = malloc(e->len + 1);
    SIM_CHECK(&s->net, bytes != NULL);
    memcpy(bytes, e->bytes, e->len);
    k->pass[k->npasses++] =
        (struct saved_pass){ bytes, e->len, e->counts, false };
}

static void
put_settled(struct sim *s, struct sim_job *job, const struct entry *e)
{
    (void)job;
    coord_settled(s->coord, s->net.now_ms, e->conn, e->request);
}

static struct sim_unit *
unit_of(struct sim *s, struct sim_job *job, uint32_t unit)
{
    struct sim_kept *k = &job->kept;

    SIM_CHECK(&s->net, unit < SIM_UNITS);
    while (k->nunits <= unit)
        k->unit[k->nunits++].there = false;
    return &k->unit[unit];
}

static void
put_unit(struct sim *s, struct sim_job *job, const struct entry *e)
{
    struct sim_unit *u = unit_of(s, job, e->unit.unit);
    struct saved_unit old = u->saved;

    u->saved = e->unit;
    if (u->there && old.attempt == e->unit.attempt) {
        u->saved.stored = old.stored;
        SIM_CHECK(&s->net, !old.done);
    } else {
        u->saved.stored = 0;
    }
    u->there = true;
    snprintf(u->worker, sizeof u->worker, "%s", e->worker);
}

static void
put_floats(struct sim_job *job, const struct action_rows *r,
           const uint8_t *from)
{
    uint32_t width = job->frame[r->frame].width;

    for (uint32_t k = 0; k < r->rows; k++)
        for (uint32_t i = 0; i < r->width; i++, from += r->channels * 4) {
            float v[4] = { 0 };

            wire_floats_get(v, from, r->channels);
            job->picture[r->frame][(r->y + k) * width + r->x + i] =
                (struct rad_pixel){ rad_rgb(v[0], v[1], v[2]), v[3] };
        }
}

static void
put_coded(struct sim *s, struct sim_job *job, const struct action_rows *r,
          const uint8_t *from)
{
    uint32_t width = job->frame[r->frame].width;
    uint8_t rgbe[4 * SIM_WIDTH];
    size_t at = 0;

    for (uint32_t k = 0; k < r->rows; k++) {
        size_t n =
            rad_hdr_decode_row(from + at, r->len - at, (int)r->width, rgbe);

        SIM_CHECK(&s->net, n > 0);
        at += n;
        for (uint32_t i = 0; i < r->width; i++)
            job->picture[r->frame][(r->y + k) * width + r->x + i].L =
                rad_rgbe_radiance(rgbe + 4 * (size_t)i);
    }
    SIM_CHECK(&s->net, at == r->len);
}

static void
put_rows(struct sim *s, struct sim_job *job, const struct entry *e)
{
    const struct action_rows *r = &e->rows;

    if (r->channels == 1)
        put_coded(s, job, r, e->bytes + e->nbottom + e->nline);
    else
        put_floats(job, r, e->bytes + e->nbottom + e->nline);
    if (e->nline)
        memcpy(job->line[r->frame] + (r->y + r->rows - 1) * e->nline,
               e->bytes + e->nbottom, e->nline);
    if (s->keeps) {
        struct sim_unit *u = unit_of(s, job, r->unit);

        SIM_CHECK(&s->net, u->there);
        SIM_CHECK(&s->net, u->saved.attempt == r->attempt);
        u->saved.stored = r->row + r->rows;
        u->saved.done = r->last;
        u->saved.end_ms = r->date_ms;
        u->saved.counts = e->counts;
        free(u->bottom);
        u->bottom = calloc(1, e->nbottom + 1);
        SIM_CHECK(&s->net, u->bottom != NULL);
        memcpy(u->bottom, e->bytes, e->nbottom);
        u->saved.nbottom = e->nbottom;
    }
    coord_rows_stored(s->coord, s->net.now_ms, r, 0, NULL);
}

static void
put_picture(struct sim *s, struct sim_job *job, const struct entry *e)
{
    SIM_CHECK(&s->net, !job->frames[e->frame].written);
    job->frames[e->frame].written = true;
    coord_picture_written(s->coord, s->net.now_ms, job->id, e->sequence,
                          e->frame, 0, NULL);
}

/* --- actions that make entries --- */

/* Take over which job's cache the coordinator has chosen, and that job's
 * options. */
static void
note_reuse(struct sim_job *job, const struct msg_spec *spec)
{
    job->spec.flags &= ~MSG_JOB_REUSE;
    job->spec.flags |= spec->flags & MSG_JOB_REUSE;
    if (!(spec->flags & MSG_JOB_REUSE))
        return;
    memcpy(job->from, spec->reuse, MSG_JOB);
    snprintf(job->params, sizeof job->params, "%s", spec->params);
}

static void
keep_job(struct sim *s, int i, const struct action *a, entry_fn *fn)
{
    struct entry *e = later(s, i, a->len, fn);

    SIM_CHECK(&s->net, coord_saved(s->coord, a->job, &e->job));
    snprintf(e->text, sizeof e->text, "%s", e->job.text);
    e->state = a->status;
    e->sequence = a->sequence;
    if (e->job.spec.flags & MSG_JOB_REUSE)
        memcpy(e->from, e->job.spec.reuse, MSG_JOB);
    if (a->type == ACT_JOB_OPEN)
        note_reuse(&s->job[i], &e->job.spec);
    e->len = a->len;
    if (a->len)
        memcpy(e->bytes, a->bytes, a->len);
}

static void
keep_rows(struct sim *s, int i, const struct action_rows *r)
{
    size_t pixels = r->channels == 1
                        ? r->len
                        : (size_t)r->rows * r->width * r->channels * 4;
    size_t line = r->line ? (size_t)r->width * 12 : 0;
    struct entry *e = later(s, i, r->nbottom + line + pixels, put_rows);

    e->rows = *r;
    if (r->last)
        e->counts = *r->counts;
    e->nbottom = r->nbottom;
    if (r->nbottom)
        memcpy(e->bytes, r->bottom, r->nbottom);
    e->nline = line;
    if (line)
        memcpy(e->bytes + r->nbottom, r->line, line);
    memcpy(e->bytes + r->nbottom + line, r->pixels, pixels);
}

static void
keep_unit(struct sim *s, int i, const struct saved_unit *u)
{
    struct entry *e = later(s, i, 0, put_unit);

    e->unit = *u;
    snprintf(e->worker, sizeof e->worker, "%.15s", u->worker);
}

void
sim_disk(struct sim *s, const struct action *a, int job)
{
    struct entry *e;

    switch (a->type) {
    case ACT_JOB_OPEN:
        keep_job(s, job, a, put_opened);
        break;
    case ACT_JOB_STATE:
        keep_job(s, job, a, put_state);
        break;
    case ACT_JOB_END:
        keep_job(s, job, a, put_end);
        break;
    case ACT_LOAD_CACHE:
        e = later(s, job, 0, put_loaded);
        e->sequence = a->sequence;
        break;
    case ACT_SETTLE:
        e = later(s, -1, 0, put_settled);
        e->conn = a->conn;
        e->request = a->request;
        break;
    case ACT_PUT_PASS:
        e = later(s, job, a->pass->len, put_pass);
        e->frame = a->frame;
        e->counts = a->pass->counts;
        e->len = a->pass->len;
        if (e->len)
            memcpy(e->bytes, a->pass->bytes, e->len);
        break;
    case ACT_KEEP_UNIT:
        keep_unit(s, job, a->unit);
        break;
    case ACT_PUT_ROWS:
        keep_rows(s, job, &a->rows);
        break;
    default:
        e = later(s, job, 0, put_picture);
        e->frame = a->frame;
        e->sequence = a->sequence;
    }
}

/* --- the coordinator's next life --- */

static bool
read_row(void *arg, const uint8_t *id, uint32_t frame, uint32_t y,
         uint8_t *pixels)
{
    struct sim *s = arg;
    const struct sim_job *job = &s->job[sim_find_job(s, id)];
    uint32_t width = job->frame[frame].width;
    size_t n = job->spec.flags & MSG_JOB_DEPTH ? 4 : 3;

    if (n == 3) {
        memcpy(pixels, job->line[frame] + (size_t)y * width * 12, width * 12);
        return true;
    }
    for (uint32_t x = 0; x < width; x++) {
        const struct rad_pixel *p = &job->picture[frame][y * width + x];
        float v[4] = { p->L.r, p->L.g, p->L.b, p->z };

        wire_floats_put(pixels + x * n * 4, v, n);
    }
    return true;
}

static void
recover(struct sim *s, struct sim_job *job)
{
    static struct saved_unit units[SIM_UNITS];
    static struct saved_pass passes[MSG_MOST_PASSES];
    struct rad_error err = { 0 };
    struct sim_kept *k = &job->kept;
    uint32_t flags = k->job.spec.flags; /* with those of the coordinator's */

    /* a job that was acknowledged is not lost */
    SIM_CHECK(&s->net, k->opened || !job->accepted);
    if (!k->opened)
        return;
    k->job.spec = job->spec;
    k->job.spec.flags = flags;
    k->job.owner = "ana";
    k->job.lives = k->lives++;
    k->job.text = k->text;
    k->job.frames = job->frames;
    k->job.units = units;
    k->job.spec.reuse = flags & MSG_JOB_REUSE ? job->from : NULL;
    memcpy(passes, k->pass, sizeof passes);
    if (flags & MSG_JOB_REUSE)
        passes[0].bytes = NULL;
    k->job.passes = passes;
    k->job.npasses = k->npasses;
    k->job.cache_bytes = k->cached ? 1 : 0;
    k->job.nunits = 0;
    for (uint32_t i = 0; i < k->nunits && k->job.state < JOB_DONE; i++) {
        k->unit[i].saved.worker = k->unit[i].worker;
        k->unit[i].saved.bottom = k->unit[i].bottom;
        if (k->unit[i].there)
            units[k->job.nunits++] = k->unit[i].saved;
    }
    if (recover_job(s->coord, s->net.now_ms, &k->job, read_row, s, &err) != 0)
        net_fail(&s->net, "recover", 0, err.what);
}

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    struct sim *s = arg;

    return s->store[sim_file(hash)];
}

void
sim_coord_born(struct sim *s)
{
    struct coord_env env = { .has_file = has_file,
                             .random = net_bytes,
                             .arg = s,
                             .program = "radcoord",
                             .epoch = ++s->lives,
                             .direct = s->direct,
                             .keeps = s->keeps };

    s->coord = coord_new(&env);
    SIM_CHECK(&s->net, s->coord != NULL);
    if (s->net.seed % 3 == 0) /* so many units count as late */
        coord_set_lease_floor(s->coord, 1500);
}

void
sim_coord_dies(struct sim *s)
{
    s->coord_deaths++;
    net_close_all(&s->net, NODE_COORD);
    coord_free(s->coord);
    sim_coord_born(s);
    s->disk_ms = s->net.now_ms;
    for (int i = 0; i < s->njobs; i++) {
        s->job[i].options[0] = '\0';
        recover(s, &s->job[i]);
    }
    for (int i = 0; i < s->nworkers; i++)
        if (s->worker[i].drained)
            SIM_CHECK(&s->net, recover_drained(s->coord, s->net.now_ms,
                                               s->worker[i].name, NULL) == 0);
    sim_coord_actions(s);
}

void
sim_disk_release(struct sim_job *job)
{
    for (uint32_t i = 0; i < SIM_UNITS; i++)
        free(job->kept.unit[i].bottom);
    for (uint32_t i = 0; i < job->kept.npasses; i++)
        free((void *)job->kept.pass[i].bytes);
    free(job->kept.stats);
}
