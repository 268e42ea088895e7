/* fuzz_rtm.c - any bytes as a compiled mesh, and rays at what comes of it */
#include "config.h"

#include "geom/geom.h"
#include "scene/meshfile.h"
#include "tests/blocked.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct input {
    const uint8_t *data;
    size_t size;
};

static unsigned char *
read_input(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    const struct input *in = arg;
    unsigned char *copy = malloc(in->size + 1);

    (void)name;
    if (!copy) {
        rad_fail_memory(err);
        return NULL;
    }
    if (in->size)
        memcpy(copy, in->data, in->size);
    *len = in->size;
    return copy;
}

/* Through the middle of the cube, and along its edges. */
static void
trace(const struct rad_geom *g, const double org[3], double size)
{
    struct rad_geom_counts counts = { 0 };

    for (int k = 0; k < 4; k++) {
        struct rad_span s = { .dir = { k == 0, k == 1, k > 1 },
                              .tmax = INFINITY };
        struct rad_hit hit;

        for (int i = 0; i < 3; i++)
            s.org[i] = org[i] + (s.dir[i] != 0 ? -size : k < 3 ? size / 2 : 0);
        if (rad_geom_nearest(g, &s, &hit, &counts) &&
            !(hit.t >= 0 && isfinite(hit.p[0] + hit.p[1] + hit.p[2]) &&
              fabs(hit.n[0]) <= 1.1 && hit.err >= 0))
            abort();
        is_blocked(g, &s, RAD_VOID, NULL, &counts);
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const strings[] = { "fuzz.rtm", "-rx", "30" };
    struct rad_object o = { .type = RAD_MESH,
                            .modifier = RAD_VOID,
                            .file = -1,
                            .name = "m",
                            .nstrings = 3,
                            .strings = strings };
    struct input input = { data, size };
    struct rad_files files = { .read = read_input, .arg = &input };
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };
    struct rad_geom *g = NULL;
    uint8_t *surf = NULL;
    int rc;

    if (!s || rad_scene_add(s, &o, NULL) < 0)
        abort();
    rc = rad_scene_include(s, &files, NULL, NULL, &err);
    if (rc != err.code || (rc && !err.what[0]))
        abort();
    if (!rc) {
        rad_scene_check(s, NULL, NULL, NULL);
        surf = calloc((size_t)s->nobjects, 1);
        g = surf ? rad_geom_new(s, surf, 0, &err) : NULL;
    }
    if (g)
        trace(g, s->parts[0]->org, s->parts[0]->size);
    rad_geom_free(g);
    free(surf);
    rad_scene_free(s);
    return 0;
}
