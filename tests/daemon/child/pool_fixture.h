/* pool_fixture.h - a pool of threads that renders a frame of a small scene
 *
 * All is static: each test program has its own. */
#ifndef RADD_TESTS_POOL_FIXTURE_H
#define RADD_TESTS_POOL_FIXTURE_H

#include "pool/pool.h"
#include "tests/world_picture.h"

static struct {
    struct world w;
    struct rad_frame frame;
    uv_loop_t loop;
    struct pool *pool; /* NULL: the test has none */
} f;

static inline void
pool_open(const char *scene, const char *options, const char *view, bool depth,
          int threads, pool_rows_fn *rows)
{
    world_open(&f.w, scene, options);
    world_frame(&f.w, view, depth, &f.frame);
    ck_assert_int_eq(uv_loop_init(&f.loop), 0);
    f.pool = pool_new(&f.loop,
                      &(struct pool_spec){ .job = f.w.job,
                                           .frames = &f.frame,
                                           .nthreads = threads,
                                           .rows = rows },
                      &f.w.err);
    ck_assert_msg(f.pool != NULL, "%s", f.w.err.what);
}

static inline void
pool_close(void)
{
    if (!f.pool)
        return;
    pool_free(f.pool);
    f.pool = NULL;
    uv_run(&f.loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&f.loop), 0);
    rad_frame_release(&f.frame);
    world_close(&f.w);
}

#endif
