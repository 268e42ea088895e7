/* wild.h - what a scene with wild arguments may do: be refused with words, or
 * give a small picture of sound pixels */
#ifndef RADD_TESTS_WILD_H
#define RADD_TESTS_WILD_H

#include "picture/frame.h"
#include "tests/world.h"

enum { WILD_SIDE = 4 /* of the pictures [pixels] */ };

/* Look at the job: every pixel is finite and not negative, and none farther
 * away than that.  False: the view cannot be, which was said. */
static inline bool
wild_look(const struct rad_job *job, const char *view, double farthest,
          const char *text)
{
    struct rad_pixel pixel[WILD_SIDE * WILD_SIDE], *rows[WILD_SIDE];
    struct rad_window all = { 0, 0, WILD_SIDE, WILD_SIDE };
    struct rad_error err = { 0 };
    struct rad_frame f;
    struct rad_ctx ctx;
    struct rad_view v;

    rad_view_init(&v);
    rad_view_line(&v, view, strlen(view), NULL);
    if (rad_frame_init(&f, job, &v, 0, true, &err) < 0)
        return false;
    ck_assert_int_eq(rad_ctx_init(&ctx, job, &err), 0);
    for (int y = 0; y < WILD_SIDE; y++)
        rows[y] = pixel + y * WILD_SIDE;
    ck_assert_int_eq(rad_frame_window(&f, &ctx, &all, rows), 0);
    for (int i = 0; i < WILD_SIDE * WILD_SIDE; i++)
        ck_assert_msg(rad_rgb_sound(pixel[i].L) && pixel[i].z >= 0 &&
                          (double)pixel[i].z <= farthest,
                      "pixel %d: %g %g %g, %g away, in\n%s", i, pixel[i].L.r,
                      pixel[i].L.g, pixel[i].L.b, pixel[i].z, text);
    rad_ctx_release(&ctx);
    rad_frame_release(&f);
    return true;
}

/* Was it refused?  Then with words, and by a code for bad scenes, or that one.
 */
static inline bool
wild_refused(int rc, int also, const struct rad_error *err, const char *text)
{
    ck_assert_msg(rc == 0 || err->what[0] != '\0', "no words for\n%s", text);
    ck_assert_msg(rc == 0 || rc == RAD_EDATA || rc == RAD_EUNSUPPORTED ||
                      rc == also,
                  "code %d, %s, for\n%s", rc, err->what, text);
    return rc < 0;
}

#endif
