/* world_picture.h - a world and a picture of it, for tests */
#ifndef RADD_TESTS_WORLD_PICTURE_H
#define RADD_TESTS_WORLD_PICTURE_H

#include "machine/jobtext.h"
#include "picture/frame.h"
#include "tests/world.h"

/* All zero before it is opened. */
struct picture {
    struct world w;
    struct rad_frame frame;
    struct rad_pixel *pixel; /* row by row; NULL before picture_render() */
};

/* What is seen of w, options of a view as text. */
static inline void
world_frame(struct world *w, const char *view, bool depth,
            struct rad_frame *frame)
{
    struct rad_view v;

    ck_assert_msg(jobtext_view(view, &v, &w->err) == 0 &&
                      rad_frame_init(frame, w->job, &v, 0, depth, &w->err) == 0,
                  "%s", w->err.what);
}

/* A window of the frame, into its place in all pixels of that. */
static inline void
world_render(struct world *w, const struct rad_frame *frame,
             struct rad_window part, struct rad_pixel *pixel)
{
    struct rad_pixel **rows = malloc((size_t)part.height * sizeof *rows);

    ck_assert_ptr_nonnull(rows);
    for (int k = 0; k < part.height; k++)
        rows[k] = pixel + (part.y + k) * frame->width + part.x;
    ck_assert_int_eq(rad_frame_window(frame, &w->ctx, &part, rows), 0);
    free(rows);
}

static inline struct rad_pixel *
picture_render(struct picture *p)
{
    struct rad_window all = { 0, 0, p->frame.width, p->frame.height };

    free(p->pixel);
    p->pixel = calloc((size_t)(all.width * all.height), sizeof *p->pixel);
    ck_assert_ptr_nonnull(p->pixel);
    world_render(&p->w, &p->frame, all, p->pixel);
    return p->pixel;
}

static inline void
picture_close(struct picture *p)
{
    free(p->pixel);
    rad_frame_release(&p->frame);
    world_close(&p->w);
    memset(p, 0, sizeof *p);
}

#endif
