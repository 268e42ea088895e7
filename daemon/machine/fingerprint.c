/* fingerprint.c - see fingerprint.h */
#include "config.h"

#include "machine/fingerprint.h"

#include "base/rng.h"
#include "picture/frame.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

#define SIDE 16 /* of the picture [pixels] */

static uint64_t
mix(uint64_t h, const void *bits, size_t n)
{
    uint64_t v = 0;

    memcpy(&v, bits, n);
    return rad_mix64(h ^ v) + UINT64_C(0x9e3779b97f4a7c15);
}

static uint64_t
mix_double(uint64_t h, double v)
{
    return mix(h, &v, sizeof v);
}

static uint64_t
mix_pixel(uint64_t h, const struct rad_pixel *p)
{
    h = mix(h, &p->L.r, sizeof p->L.r);
    h = mix(h, &p->L.g, sizeof p->L.g);
    return mix(h, &p->L.b, sizeof p->L.b);
}

/* What pictures may take from the C library, as tests/doors.sh lists it.
 * Arguments over several magnitudes; volatile, or the compiler would take its
 * own library's results instead of the machine's. */
static uint64_t
mix_functions(uint64_t h)
{
    for (int i = 1; i <= 64; i++) {
        volatile double x = i * 0.0487213 + 0.013, y = i * i * 1e8 * x;

        h = mix_double(h, erf(x));
        h = mix_double(h, erfc(x * 2));
        h = mix_double(h, sin(y)); /* beyond the range of our own */
        h = mix_double(h, cos(y));
    }
    return h;
}

struct definition {
    enum rad_otype type;
    int modifier; /* row of it, or RAD_VOID */
    const char *name;
    int nreals;
    double reals[12];
};

/* A gloss sphere, a cone and a ground under two lights. */
static const struct definition scene_rows[] = {
    { RAD_LIGHT, RAD_VOID, "white", 3, { 90, 80, 70 } },
    { RAD_PLASTIC, RAD_VOID, "gloss", 5, { .5, .4, .3, .05, .1 } },
    { RAD_PLASTIC, RAD_VOID, "ground", 5, { .3, .35, .2, 0, 0 } },
    { RAD_SPHERE, 0, "lamp", 4, { 3, -2, 4, .3 } },
    { RAD_SPHERE, 1, "ball", 4, { .3, 0, 1.1, 1 } },
    { RAD_CONE, 2, "hat", 8, { -1.3, .2, 0, -1.1, .4, 1.7, .7, .1 } },
    { RAD_POLYGON, 2, "floor", 12, { -5, -5, 0, 5, -5, 0, 5, 5, 0, -5, 5, 0 } },
    { RAD_POLYGON, 0, "panel", 9, { -2, -3, 4, -2, -2, 4.1, -3, -2, 4.2 } },
};

static struct rad_scene *
make_scene(struct rad_error *err)
{
    struct rad_scene *s = rad_scene_new();
    int n = (int)(sizeof scene_rows / sizeof scene_rows[0]);

    for (int i = 0; s && i < n; i++) {
        const struct definition *d = &scene_rows[i];
        struct rad_object o = { .type = d->type,
                                .modifier = d->modifier,
                                .file = -1,
                                .name = d->name,
                                .nreals = d->nreals,
                                .reals = d->reals };

        if (rad_scene_add(s, &o, err) < 0) {
            rad_scene_free(s);
            return NULL;
        }
    }
    return s;
}

static int
mix_picture(uint64_t *h, const struct rad_job *job, struct rad_error *err)
{
    struct rad_view view;
    struct rad_frame frame;
    struct rad_ctx ctx;
    struct rad_pixel p;
    int rc;

    rad_view_init(&view);
    view.vp[0] = .5;
    view.vp[1] = -6;
    view.vp[2] = 2.3;
    rc = rad_frame_init(&frame, job, &view, 0, false, err);
    if (rc < 0)
        return rc;
    rc = rad_ctx_init(&ctx, job, err);
    if (rc == 0) {
        for (int i = 0; i < SIDE * SIDE; i++) {
            rad_frame_pixel(&frame, &ctx, i % SIDE, i / SIDE, &p);
            *h = mix_pixel(*h, &p);
        }
        rad_ctx_release(&ctx);
    }
    rad_frame_release(&frame);
    return rc;
}

int
fingerprint(uint64_t *out, struct rad_error *err)
{
    struct rad_params params;
    struct rad_scene *scene = make_scene(err);
    struct rad_job *job;
    uint64_t h = mix_functions(1);
    int rc;

    if (!scene)
        return rad_fail_memory(err);
    rad_params_init(&params);
    params.xres = params.yres = SIDE;
    params.ambounce = 1;
    params.ambacc = 0; /* no records */
    params.ambdiv = 16;
    params.ambssamp = 0;
    job = rad_job_new(scene, &params, NULL, err);
    rc = job ? mix_picture(&h, job, err)
             : rad_fail(err, RAD_EINTERNAL, "cannot compile the test scene");
    rad_job_free(job);
    rad_scene_free(scene);
    *out = h ? h : 1;
    return rc;
}
