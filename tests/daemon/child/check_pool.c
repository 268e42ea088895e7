/* check_pool.c - threads that render give the pixels that one alone gives */
#include "config.h"

#include "machine/fingerprint.h"
#include "machine/jobtext.h"
#include "light/indirect/ambient.h"
#include "pool/pool_impl.h"
#include "team/team.h"

#include "pool_fixture.h"
#include "tests/tools/hook.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

FIXTURE(NULL, pool_close)

enum { SIDE = 96, WINDOW = 24, PER_ROW = SIDE / WINDOW, MOST = 16 };

static const char scene_text[] =
    "void light lamp 0 0 3 60 60 60\n"
    "lamp sphere bulb 0 0 4 2 -2 4 .4\n"
    "lamp sphere spark 0 0 4 -1.5 1 2 .02\n" /* painted */
    "void plastic red 0 0 5 .6 .2 .2 .02 .05\n"
    "red sphere ball 0 0 4 0 0 1 1\n"
    "void plastic grey 0 0 5 .4 .4 .4 0 0\n"
    "grey polygon floor 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";

/* Threads wait before they trace a pixel there. */
static struct {
    _Atomic int row, ystep; /* from that row on, of no base line; 0: nowhere */
    _Atomic bool reached;
} gate;

void
test_hook_pixel(const struct rad_scene *scene, int x, int y)
{
    int row = atomic_load(&gate.row);

    (void)scene;
    (void)x;
    if (row == 0 || y < row || y % atomic_load(&gate.ystep) == 0)
        return;
    atomic_store(&gate.reached, true);
    while (atomic_load(&gate.row) > 0)
        uv_sleep(1);
}

/* What the threads gave. */
static struct {
    struct rad_pixel whole[SIDE][SIDE];
    int side; /* of a window */
    int nlast, nrows[MOST];
    uint64_t primary, again;
    bool in_order;
} got;

static void
on_rows(void *arg, const struct pool_rows *r)
{
    const struct rad_window *w = &r->unit.window;
    const float *p = (const float *)r->pixels;

    (void)arg;
    ck_assert_int_eq(r->err.code, 0);
    if (got.nrows[r->unit.unit] != (int)r->row)
        got.in_order = false;
    got.nrows[r->unit.unit] += (int)r->rows;
    for (uint32_t k = 0; k < r->rows; k++)
        for (int x = 0; x < w->width; x++, p += r->channels) {
            struct rad_pixel *to =
                &got.whole[w->y + (int)(r->row + k)][w->x + x];

            to->L = rad_rgb(p[0], p[1], p[2]);
            to->z = r->channels == 4 ? p[3] : 0;
        }
    if (r->last) {
        got.nlast++;
        got.primary += r->counts.primary_rays;
        got.again += r->counts.estimate_rays;
        ck_assert_int_eq(got.nrows[r->unit.unit], w->height);
    }
    pool_sent(f.pool,
              r->rows * (size_t)w->width * (size_t)r->channels * sizeof(float));
}

static void
open_pool(const char *options, bool depth, int threads)
{
    memset(&got, 0, sizeof got);
    got.in_order = true;
    pool_open(scene_text, options, "-vp 0 -6 2 -vd 0 1 -.2", depth, threads,
              on_rows);
}

static struct pool_unit
unit_of(int i, int side)
{
    int per_row = SIDE / side;
    struct pool_unit u = { .unit = (uint32_t)i,
                           .attempt = 1,
                           .window = { side * (i % per_row),
                                       side * (i / per_row), side, side } };

    return u;
}

static struct pool_unit
unit(int i)
{
    return unit_of(i, WINDOW);
}

/* The same windows by one context. */
static uint64_t
render_alone(struct rad_pixel whole[SIDE][SIDE])
{
    int n = SIDE / got.side * (SIDE / got.side);

    for (int i = 0; i < n; i++)
        world_render(&f.w, &f.frame, unit_of(i, got.side).window, whole[0]);
    return f.w.ctx.counts.primary_rays;
}

static const struct {
    const char *options;
    bool depth;
    int threads;
    int side;
} pools[] = {
    { "-x 96 -y 96 -ab 0 -ps 4 -pj .67", false, 1, WINDOW },
    { "-x 96 -y 96 -ab 0 -ps 4 -pj .67", false, 4, WINDOW },
    { "-x 96 -y 96 -ab 0 -ps 1 -dj .5", true, 3, WINDOW },
    { "-x 96 -y 96 -ab 0 -ps 16 -pt .2", true, 2, WINDOW },
    /* all threads on one window */
    { "-x 96 -y 96 -ab 0 -ps 4 -pj .67", false, 1, SIDE },
    { "-x 96 -y 96 -ab 0 -ps 4 -pt .05 -pj .67", false, 2, SIDE },
    { "-x 96 -y 96 -ab 0 -ps 6 -pt .01 -pj 0", true, 3, SIDE },
    { "-x 96 -y 96 -ab 0 -ps 1", false, 7, SIDE },
    { "-x 96 -y 96 -ab 0 -ps 2", false, 5, SIDE },
    { "-x 96 -y 96 -ab 0 -ps 16 -pt .2", true, 16, SIDE },
};

LOOP_TEST(threads_give_the_pixels_of_one, N_ELEM(pools))
{
    static struct rad_pixel alone[SIDE][SIDE];

    int n = SIDE / pools[_i].side * (SIDE / pools[_i].side);

    open_pool(pools[_i].options, pools[_i].depth, pools[_i].threads);
    got.side = pools[_i].side;
    for (int i = 0; i < n; i++) {
        struct pool_unit u = unit_of(i, got.side);

        ck_assert(pool_push(f.pool, &u));
    }
    while (got.nlast < n)
        uv_run(&f.loop, UV_RUN_ONCE);
    memset(alone, 0, sizeof alone);
    ck_assert_uint_eq(render_alone(alone), got.primary);
    ck_assert_uint_gt(got.again, 0); /* which estimate the error */
    ck_assert(got.in_order);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            ck_assert_mem_eq(&got.whole[y][x].L, &alone[y][x].L,
                             sizeof alone[y][x].L);
            if (pools[_i].depth)
                ck_assert_mem_eq(&got.whole[y][x].z, &alone[y][x].z,
                                 sizeof(float));
        }
    ck_assert_double_gt(pool_tally(f.pool).busy_s, 0);
    ck_assert_double_le(pool_tally(f.pool).wait_base_line_s,
                        pool_tally(f.pool).busy_s);
    ck_assert_uint_eq(pool_tally(f.pool).rays_under_way, 0);
}

struct rays_seen {
    struct team *team;
    const struct rad_frame *frame;
    const struct rad_ctx *ctx;
    uint64_t last;
    int rows;
};

/* A row is handed on when the line below it, too, has told its rays. */
static void
see_rays(void *arg, int row, const struct rad_pixel *pixels)
{
    struct rays_seen *s = arg;
    uint64_t n = team_rays(s->team);

    (void)row;
    (void)pixels;
    ck_assert_uint_gt(n, 0);
    ck_assert_uint_ge(n, s->last);
    ck_assert_uint_eq(n, s->ctx->counts.rays);
    s->last = n;
    s->rows++;
}

static bool
trace_frame(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    const struct rays_seen *s = arg;

    return rad_frame_pixel(s->frame, ctx, x, y, out);
}

static uint64_t
count_rays(void *arg, const struct rad_ctx *ctx)
{
    const struct rays_seen *s = arg;

    ck_assert_ptr_eq(ctx, s->ctx);
    return ctx->counts.rays;
}

TEST(rays_are_told_while_a_window_is_under_way)
{
    static const struct rad_window all = { 0, 0, SIDE, SIDE };
    struct rays_seen seen = { .frame = &f.frame };
    struct team_spec spec = { .mode = TEAM_TRUTH,
                              .trace = trace_frame,
                              .truth.rows = see_rays,
                              .count = count_rays,
                              .arg = &seen,
                              .nthreads = 1 };

    open_pool("-x 96 -y 96 -ab 0 -ps 4", false, 1);
    seen.ctx = &f.w.ctx;
    rad_frame_sampler(&f.frame, &all, &spec.sampler);
    spec.last = rad_quincunx_nbases(&spec.sampler);
    seen.team = team_new(&spec);
    ck_assert_ptr_nonnull(seen.team);
    team_work(seen.team, &f.w.ctx);
    ck_assert_int_eq(seen.rows, SIDE);
    ck_assert(team_waited(seen.team) == 0); /* for whom? */
    team_free(seen.team);
}

/* --- strict units, of one frame, by several children --- */

enum { MOST_UNITS = 2 * SIDE, CHILDREN = 3 };

struct child {
    struct cluster *of;
    struct strict *strict;
    struct pool *pool;
    uint64_t due; /* when its machine is to be told the time [ms] */
};

struct part {
    int first, last; /* lines */
    bool done, twin;
    int rows[CHILDREN];
};

struct cluster {
    struct rad_quincunx q;
    int nchildren, nparts, ndone, parked, gave;
    struct child child[CHILDREN];
    struct part part[MOST_UNITS];
    uv_timer_t timer;
    uint64_t ms, random;
    struct msg_counts counts;
};

static int
any(struct cluster *c, int n)
{
    c->random = c->random * UINT64_C(6364136223846793005) + 1442695040888963407;
    return (int)(c->random >> 33) % n;
}

static void
give_part(struct cluster *c, int i, int to, uint8_t flags)
{
    struct part *part = &c->part[i];
    int y = team_line_row(&c->q, part->first);
    struct msg_unit m = { .unit = (uint32_t)i,
                          .attempt = 1,
                          .y = (uint32_t)y,
                          .width = SIDE,
                          .mode = MSG_MODE_STRICT,
                          .flags = flags };

    m.height = (uint32_t)(rad_quincunx_base_row(&c->q, part->last - 1) + 1 - y);
    part->rows[to] = 0;
    ck_assert_int_eq(strict_unit(pool_lock_strict(c->child[to].pool), &m, NULL),
                     0);
    pool_unlock_strict(c->child[to].pool);
}

/* Somebody has less to do from now on: another gets the rest. */
static void
on_gave(struct cluster *c, const struct msg_gave *m)
{
    struct part *part = &c->part[m->unit];
    int y = team_line_row(&c->q, part->first) + (int)m->height - 1;
    int last = part->first;

    while (rad_quincunx_base_row(&c->q, last) < y)
        last++;
    last++;
    ck_assert_int_le(last, part->last);
    if (last == part->last)
        return;
    c->gave++;
    c->part[c->nparts] = (struct part){ .first = last, .last = part->last };
    part->last = last;
    give_part(c, c->nparts++, any(c, c->nchildren), MSG_UNIT_TOP);
}

static void
on_children_news(void *arg)
{
    struct child *from = arg;
    struct cluster *c = from->of;
    const struct msg *m;

    from->due = pool_tick(from->pool, c->ms);
    while ((m = pool_message(from->pool, true))) {
        c->parked += m->type == MSG_PARKED;
        if (m->type == MSG_GAVE)
            on_gave(c, &m->gave);
        for (int i = 0; i < c->nchildren; i++) {
            struct pool *to = c->child[i].pool;
            struct strict *s;

            if (&c->child[i] == from ||
                (m->type != MSG_BASE_LINE && m->type != MSG_FACTS))
                continue;
            s = pool_lock_strict(to);
            if (m->type == MSG_FACTS)
                strict_facts(s, &m->facts);
            else
                strict_base_line(s, &m->base_line);
            pool_unlock_strict(to);
        }
    }
}

static void
take_pixels(const struct pool_rows *r, int y)
{
    const float *p = (const float *)r->pixels;

    for (uint32_t k = 0; k < r->rows; k++)
        for (int x = 0; x < SIDE; x++, p += r->channels) {
            got.whole[y + (int)k][x].L = rad_rgb(p[0], p[1], p[2]);
            got.whole[y + (int)k][x].z = r->channels == 4 ? p[3] : 0;
        }
}

static void
on_part_rows(void *arg, const struct pool_rows *r)
{
    struct child *from = arg;
    struct cluster *c = from->of;
    struct part *part = &c->part[r->unit.unit];
    int *rows = &part->rows[from - c->child];

    pool_sent(from->pool, sizeof(float) * r->rows * SIDE * (size_t)r->channels);
    if (part->done)
        return;
    ck_assert_int_eq(*rows, (int)r->row);
    *rows += (int)r->rows;
    take_pixels(r, team_line_row(&c->q, part->first) + (int)r->row);
    if (!r->last)
        return;
    ck_assert_int_eq(*rows, rad_quincunx_base_row(&c->q, part->last - 1) + 1 -
                                team_line_row(&c->q, part->first));
    part->done = true;
    c->ndone++;
    msg_counts_add(&c->counts, &r->counts);
    for (int i = 0; i < c->nchildren; i++)
        if (&c->child[i] != from)
            pool_revoke(c->child[i].pool, r->unit.unit, 1);
}

static void
on_cluster_timer(uv_timer_t *timer)
{
    struct cluster *c = timer->data;

    c->ms += 60; /* a hurry: parked soon */
    for (int i = 0; i < c->nchildren; i++)
        if (c->ms >= c->child[i].due)
            on_children_news(&c->child[i]);
}

static void
open_cluster(struct cluster *c, int nchildren, int nthreads)
{
    static const struct rad_window all = { 0, 0, SIDE, SIDE };
    static const uint8_t id[MSG_JOB];

    memset(c, 0, sizeof *c);
    c->random = 1;
    c->nchildren = nchildren;
    rad_frame_sampler(&f.frame, &all, &c->q);
    for (int i = 0; i < nchildren; i++) {
        struct child *k = &c->child[i];

        k->of = c;
        k->due = STRICT_NEVER;
        k->strict = strict_new(&c->q, 1, true, id);
        k->pool = pool_new(&f.loop,
                           &(struct pool_spec){ .job = f.w.job,
                                                .frames = &f.frame,
                                                .strict = k->strict,
                                                .nthreads = nthreads,
                                                .rows = on_part_rows,
                                                .news = on_children_news,
                                                .arg = k },
                           NULL);
        ck_assert(k->strict && k->pool);
    }
    uv_timer_init(&f.loop, &c->timer);
    c->timer.data = c;
    uv_timer_start(&c->timer, on_cluster_timer, 1, 1);
}

static void
close_cluster(struct cluster *c)
{
    uv_close((uv_handle_t *)&c->timer, NULL);
    for (int i = 0; i < c->nchildren; i++) {
        pool_free(c->child[i].pool);
        strict_free(c->child[i].strict);
    }
}

static const struct {
    const char *options;
    bool depth;
    int children, threads;
    int lines; /* of a unit, at most */
    bool split, twins;
} clusters[] = {
    { "-x 96 -y 96 -ab 0 -ps 4 -pt .05 -pj .67", false, 1, 1, 99, false,
      false },
    { "-x 96 -y 96 -ab 0 -ps 4 -pt .05 -pj .67", false, 1, 3, 1, false, false },
    { "-x 96 -y 96 -ab 0 -ps 4 -pt .05 -dj .5", true, 3, 1, 1, false, false },
    { "-x 96 -y 96 -ab 0 -ps 8 -pt .02 -pj 0", false, 3, 2, 4, false, false },
    { "-x 96 -y 96 -ab 0 -ps 3 -pt .05", true, 2, 3, 12, true, false },
    { "-x 96 -y 96 -ab 0 -ps 4 -pt .05 -pj .67", false, 3, 1, 20, true, true },
    { "-x 96 -y 96 -ab 0 -ps 2 -pt .05", false, 3, 2, 9, true, true },
    { "-x 96 -y 96 -ab 0 -ps 1", false, 2, 2, 30, true, true },
    { "-x 96 -y 96 -ab 0 -ps 16 -pt .1", true, 3, 2, 2, false, true },
};

/* Everything is handed out at once, here and there. */
static void
give_all(struct cluster *c, int most, bool twins)
{
    int nlines = rad_quincunx_nbases(&c->q);

    for (int first = 0; first < nlines; c->nparts++) {
        struct part *part = &c->part[c->nparts];

        part->first = first;
        first += 1 + any(c, most);
        part->last = first < nlines ? first : nlines;
        first = part->last;
    }
    for (int i = c->nparts - 1; i >= 0; i--) {
        int to = any(c, c->nchildren), other = (to + 1) % c->nchildren;
        bool twin = twins && other != to && any(c, 3) == 0;
        uint8_t flags = any(c, 3) == 0 ? MSG_UNIT_TOP : 0;

        c->part[i].twin = twin;
        if (twin)
            give_part(c, i, other, flags);
        give_part(c, i, to, flags);
    }
}

/* Whoever has it.  Twins are not split. */
static void
split_any(struct cluster *c)
{
    int unit = any(c, c->nparts);

    for (int i = 0; i < c->nchildren && !c->part[unit].twin; i++) {
        strict_split(pool_lock_strict(c->child[i].pool), (uint32_t)unit, 1);
        pool_unlock_strict(c->child[i].pool);
    }
}

LOOP_TEST(strict_units_give_the_picture_and_rays_of_one, N_ELEM(clusters))
{
    static struct rad_pixel alone[SIDE][SIDE];
    static struct cluster c;
    uint64_t primary;

    open_pool(clusters[_i].options, clusters[_i].depth, 1);
    got.side = SIDE;
    primary = render_alone(alone);
    open_cluster(&c, clusters[_i].children, clusters[_i].threads);
    give_all(&c, clusters[_i].lines, clusters[_i].twins);
    while (c.ndone < c.nparts) {
        uv_run(&f.loop, UV_RUN_ONCE);
        if (clusters[_i].split)
            split_any(&c);
    }
    ck_assert_uint_eq(c.counts.primary_rays, primary);
    for (int y = 0; y < SIDE; y++)
        ck_assert_mem_eq(got.whole[y], alone[y], sizeof alone[y]);
    ck_assert_int_eq(f.frame.paint.n, 1);
    ck_assert_uint_gt(c.counts.paint_rays, 0);
    if (!clusters[_i].twins) /* whose rays serve one that counts none of them */
        ck_assert_uint_ge(c.counts.rays, c.counts.primary_rays);
    close_cluster(&c);
}

/* Rows that go elsewhere; NULL: none, for a long time. */
static const struct pool_rows *
first_done(struct pool *p)
{
    const struct pool_rows *r = NULL;

    for (int i = 0; i < 20000 && !r; i++) {
        uv_mutex_lock(&p->mu);
        r = p->done;
        uv_mutex_unlock(&p->mu);
        if (!r)
            uv_sleep(1);
    }
    return r;
}

/* A pass that ends early leaves its rows in the queue, however full that is:
 * another thread may go on with the unit, and its rows come after. */
TEST(rows_of_a_pass_that_ends_early_go_first)
{
    static struct cluster c;
    const struct pool_rows *r;
    struct pool *p;

    open_pool("-x 96 -y 96 -ab 0 -ps 4 -pt 0", false, 1);
    open_cluster(&c, 1, 1);
    p = c.child[0].pool;
    c.nparts = 1;
    c.part[0] = (struct part){ .first = 0, .last = 12 };
    atomic_store(&gate.ystep, c.q.ystep);
    atomic_store(&gate.reached, false);
    atomic_store(&gate.row, 6 * c.q.ystep);
    give_part(&c, 0, 0, 0);
    while (!atomic_load(&gate.reached))
        uv_sleep(1);
    pool_lock_strict(p);
    p->active->pass->stop = true;
    p->unsent = POOL_UNSENT + 1;
    pool_unlock_strict(p);
    atomic_store(&gate.row, 0);
    r = first_done(p);
    ck_assert_ptr_nonnull(r);
    ck_assert(r->unit.unit == 0 && r->rows > 0 && !r->last);
    pool_sent(p, POOL_UNSENT + 1);
    while (c.ndone < 1)
        uv_run(&f.loop, UV_RUN_ONCE);
    close_cluster(&c);
}

TEST(shared_cache_fills_while_threads_read_it)
{
    open_pool("-x 96 -y 96 -ab 1 -ad 32 -as 0 -ps 4", false, 4);
    for (int i = 0; i < PER_ROW * PER_ROW; i++) {
        struct pool_unit u = unit(i);

        ck_assert(pool_push(f.pool, &u));
    }
    while (got.nlast < PER_ROW * PER_ROW)
        uv_run(&f.loop, UV_RUN_ONCE);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            ck_assert(rad_rgb_sound(got.whole[y][x].L));
}

/* What a ray cannot hold it leaves out, and the pixel would be wrong. */
TEST(a_thread_without_scratch_memory_ends_the_process)
{
    int status;
    pid_t pid;

    open_pool("-x 96 -y 96 -ab 0 -ps 1", false, 1);
    pid = fork();
    if (pid == 0) {
        rad_arena_alloc(&f.pool->renderers[0].ctx.scratch, SIZE_MAX);
        _exit(EX_OK);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert_msg(WIFEXITED(status) && WEXITSTATUS(status) == EX_OSERR,
                  "status %#x", (unsigned)status);
}

TEST(revoked_units_are_not_done)
{
    open_pool("-x 96 -y 96 -ab 0 -ps 1", false, 1);
    atomic_store(&gate.ystep, SIDE); /* the thread comes to no second unit */
    atomic_store(&gate.row, 1);
    for (int i = 0; i < PER_ROW * PER_ROW; i++) {
        struct pool_unit u = unit(i);

        ck_assert(pool_push(f.pool, &u));
    }
    pool_revoke(f.pool, 0, 2); /* another attempt's */
    pool_revoke(f.pool, PER_ROW * PER_ROW - 1, 1);
    pool_revoke(f.pool, 5, 1);
    atomic_store(&gate.row, 0);
    while (got.nlast < PER_ROW * PER_ROW - 2)
        uv_run(&f.loop, UV_RUN_ONCE);
    ck_assert_int_eq(got.nrows[0], WINDOW);
    ck_assert_int_eq(got.nrows[PER_ROW * PER_ROW - 1], 0);
}

TEST(pool_ends_in_the_middle)
{
    open_pool("-x 96 -y 96 -ab 0 -ps 1", false, 2);
    for (int i = 0; i < PER_ROW * PER_ROW; i++) {
        struct pool_unit u = unit(i);

        ck_assert(pool_push(f.pool, &u));
    }
    uv_run(&f.loop, UV_RUN_ONCE);
}

TEST(fingerprint_is_the_same_each_time)
{
    uint64_t a = 0, b = 0;
    struct rad_error err = { 0 };

    ck_assert_msg(fingerprint(&a, &err) == 0, "%s", err.what);
    ck_assert_int_eq(fingerprint(&b, &err), 0);
    ck_assert_uint_eq(a, b);
    ck_assert_uint_ne(a, 0);
}

static const char *const bad_texts[] = { "-zz 1", "-ab", "-ab x", "office",
                                         "-vp 0 0 0" };

LOOP_TEST(bad_options_of_a_job_are_refused, N_ELEM(bad_texts))
{
    struct rad_params p;
    struct rad_view v;
    struct rad_error err = { 0 };

    ck_assert_int_eq(jobtext_params(bad_texts[_i], &p, &err), RAD_EDATA);
    ck_assert_str_ne(err.what, "");
    ck_assert_int_eq(jobtext_view("-ab 1", &v, NULL), RAD_EDATA);
    ck_assert_int_eq(jobtext_view("-vd 0 0 0", &v, NULL), RAD_EDATA);
}

TEST(pixel_aspect_follows_the_view_where_it_is_free)
{
    double pa;

    ck_assert_int_eq(
        jobtext_pixaspect("-pa 1.5", "-vh 40 -vv 40", 300, 200, &pa, NULL), 0);
    ck_assert_double_eq(pa, 1.5);
    ck_assert_int_eq(
        jobtext_pixaspect("-pa 0", "-vtl -vh 2 -vv 1", 400, 100, &pa, NULL), 0);
    ck_assert_double_eq_tol(pa, 2, 1e-12);
}
