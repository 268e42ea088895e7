/* frames.c - see frames.h */
#include "config.h"

#include "job/frames.h"

#include "common/outname.h"

#include "base/files.h"
#include "base/list.h"
#include "image/filter.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LONGEST_VIEWS = 64 << 20 /* most bytes of a views file */ };

/* Make room for one more frame. */
static int
reserve(struct frames *f, struct rad_error *err)
{
    if (f->n >= MSG_MAX_FRAMES)
        return rad_fail(err, RAD_EUSAGE, "more than %d views", MSG_MAX_FRAMES);
    return rad_list_grow(&f->list, f->n, sizeof *f->list)
               ? 0
               : rad_fail_memory(err);
}

/* Check the size of what is rendered. */
static int
check_size(const struct submit_options *o, int width, int height,
           struct rad_error *err)
{
    int n = o->oversample;

    if (rad_filter_side(width, n) < 1 || rad_filter_side(height, n) < 1)
        return rad_fail(err, RAD_EUSAGE,
                        "a picture of %d by %d pixels, by -x, -y and the "
                        "view's proportions: nothing to render",
                        rad_filter_side(width, n), rad_filter_side(height, n));
    if (width <= MSG_MAX_COLUMNS && height <= MSG_MAX_SIDE)
        return 0;
    if (n == 1)
        return rad_fail(err, RAD_EUSAGE,
                        "a picture of %d by %d pixels: at most %d by %d are "
                        "allowed",
                        width, height, MSG_MAX_COLUMNS, MSG_MAX_SIDE);
    return rad_fail(err, RAD_EUSAGE,
                    "a picture of %d by %d pixels with --oversample=%d is "
                    "rendered as %d by %d: at most %d by %d are allowed",
                    rad_filter_side(width, n), rad_filter_side(height, n), n,
                    width, height, MSG_MAX_COLUMNS, MSG_MAX_SIDE);
}

static int
add(struct frames *f, const struct submit_options *o,
    const struct rad_view *as_given, uint32_t number, struct rad_error *err)
{
    struct rad_view v = *as_given;
    double aspect = o->params.pixaspect;
    int width = o->params.xres, height = o->params.yres, rc;
    char text[RAD_VIEW_TEXT], *view;

    if ((rc = rad_view_setup(&v, err)) < 0 || (rc = reserve(f, err)) < 0)
        return rc;
    rad_view_resolution(&v, &aspect, &width, &height);
    if ((rc = check_size(o, width, height, err)) < 0)
        return rc;
    rad_view_format(as_given, text, sizeof text);
    view = rad_arena_strndup(&f->arena, text, strlen(text));
    if (!view)
        return rad_fail_memory(err);
    f->list[f->n++] = (struct msg_frame){ .number = number,
                                          .width = (uint32_t)width,
                                          .height = (uint32_t)height,
                                          .view = view };
    return 0;
}

/* Add a frame of a sequence, unless --no-clobber is given and its picture
 * exists. */
static int
add_frame(struct frames *f, const struct submit_options *o,
          const struct rad_view *v, uint32_t number, struct rad_error *err)
{
    char *name;
    bool there;
    int rc;

    f->seen++;
    if (!o->no_clobber)
        return add(f, o, v, number, err);
    rc = outname_frame(&name, o->output, (int)number, true, err);
    if (rc < 0)
        return rc;
    there = access(name, F_OK) == 0;
    free(name);
    return there ? 0 : add(f, o, v, number, err);
}

/* Add a frame for each view line of the text. */
static int
add_lines(struct frames *f, const struct submit_options *o, const char *name,
          const char *text, size_t len, struct rad_error *err)
{
    struct rad_view v = o->view;
    const char *end = text + len;
    uint32_t number = (uint32_t)o->first_frame;

    for (int line = 1; text < end; line++) {
        const char *nl = memchr(text, '\n', (size_t)(end - text));
        size_t n = nl ? (size_t)(nl - text) : (size_t)(end - text);
        int rc = rad_view_read(&v, text, n, err);

        if (rc > 0 && number > (uint32_t)INT_MAX)
            rc = rad_fail(err, RAD_EUSAGE, "frame numbers beyond %d", INT_MAX);
        if (rc > 0)
            rc = add_frame(f, o, &v, number++, err);
        if (rc < 0) {
            rad_error_where(err, "%s:%d", name, line);
            return rc;
        }
        text += n + (nl != NULL);
    }
    return 0;
}

static int
add_file(struct frames *f, const struct submit_options *o,
         struct rad_error *err)
{
    const char *name = o->views ? o->views : "standard input";
    unsigned char *text;
    size_t len;
    int rc;

    if (o->views)
        text = rad_file_read(name, LONGEST_VIEWS, &len, err);
    else
        text = rad_fd_read(0, name, LONGEST_VIEWS, &len, err);
    if (!text)
        return err->code;
    rc = add_lines(f, o, name, (const char *)text, len, err);
    free(text);
    if (rc == 0 && f->seen == 0) {
        rad_error_where(err, "%s", name);
        rc = rad_fail(err, RAD_EDATA,
                      "no view line, as 'VIEW= -vp 1 2 3 -vd 0 1 0'");
    }
    return rc;
}

int
frames_init(struct frames *f, const struct submit_options *o,
            struct rad_error *err)
{
    memset(f, 0, sizeof *f);
    rad_arena_init(&f->arena);
    if (o->first_frame > 0)
        return add_file(f, o, err);
    return add(f, o, &o->view, 0, err);
}

int
frames_init_points(struct frames *f, int width, int height,
                   struct rad_error *err)
{
    int rc;

    memset(f, 0, sizeof *f);
    rad_arena_init(&f->arena);
    rc = reserve(f, err);
    if (rc < 0)
        return rc;
    f->list[f->n++] = (struct msg_frame){ .width = (uint32_t)width,
                                          .height = (uint32_t)height,
                                          .view = "" };
    return 0;
}

int
frames_init_views(struct frames *f, const struct submit_options *o,
                  const struct frames_view *views, int n, struct rad_error *err)
{
    int rc = 0;

    memset(f, 0, sizeof *f);
    rad_arena_init(&f->arena);
    f->names = rad_arena_calloc(&f->arena, (size_t)n, sizeof *f->names);
    if (!f->names)
        return rad_fail_memory(err);
    for (int i = 0; i < n && rc == 0; i++) {
        rc = add(f, o, &views[i].view, views[i].number, err);
        if (rc < 0)
            rad_error_where(err, "view '%.60s'", views[i].name);
        else if (!(f->names[i] = rad_arena_strndup(&f->arena, views[i].name,
                                                   strlen(views[i].name))))
            rc = rad_fail_memory(err);
    }
    return rc;
}

int
frames_name(const struct frames *f, const struct submit_options *o,
            const char *pattern, uint32_t frame, char **name,
            struct rad_error *err)
{
    if (f->names)
        return outname_view(name, pattern, f->names[frame], f->n > 1, err);
    if (o->first_frame > 0)
        return outname_frame(name, pattern, (int)f->list[frame].number, true,
                             err);
    *name = strdup(pattern);
    return *name ? 0 : rad_fail_memory(err);
}

void
frames_release(struct frames *f)
{
    free(f->list);
    rad_arena_release(&f->arena);
    memset(f, 0, sizeof *f);
}
