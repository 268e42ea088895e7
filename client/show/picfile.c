/* picfile.c - see picfile.h */
#include "config.h"

#include "show/picfile.h"

#include "common/outname.h"

#include "base/output.h"
#include "tone/primaries.h"

#include <limits.h>
#include <string.h>

/* suffixes of formats that are not supported */
static const char *const others[] = { ".bmp", ".exr", ".gif",  ".jpeg",
                                      ".jpg", ".pdf", ".pfm",  ".ppm",
                                      ".tga", ".tif", ".tiff", ".webp" };
static const char *const rgbe[] = { ".hdr", ".pic" };

static bool
ends_in(const char *path, const char *const *suffix, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (outname_suffix(path, suffix[i]))
            return true;
    return false;
}

int
picfile_check(const char *path, bool always_png, struct rad_error *err)
{
    if (!ends_in(path, others, sizeof others / sizeof others[0]) &&
        !(always_png && ends_in(path, rgbe, sizeof rgbe / sizeof rgbe[0])))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "'%s': that format is not written there: use a name in %s",
                    path, always_png ? ".png" : ".hdr, .pic or .png");
}

static int
put(void *arg, const void *data, size_t len, struct rad_error *err)
{
    (void)err; /* a failure is found at the commit */
    (void)!fwrite(data, 1, len, arg);
    return 0;
}

bool
picfile_is_png(const char *path, enum picfile_format format)
{
    return format == PICFILE_PNG || (format == PICFILE_BY_SUFFIX && path &&
                                     outname_suffix(path, ".png"));
}

/* A picture with the view in its header. */
struct seen {
    struct rad_picture pic;
    struct rad_view view;
    const struct rad_view *known; /* &view; NULL: the header has none */
};

static int
see(struct seen *s, const uint8_t *hdr, size_t n, struct rad_error *err)
{
    int rc;

    memset(s, 0, sizeof *s);
    if ((rc = rad_hdr_read(hdr, n, INT_MAX, &s->pic, err)) < 0)
        return rc;
    rad_primaries_convert(&s->pic);
    rad_view_init(&s->view);
    if (rad_view_read(&s->view, (const char *)hdr, n, NULL) > 0 &&
        rad_view_setup(&s->view, NULL) == 0)
        s->known = &s->view;
    return 0;
}

/* Write a picture as PNG: a whole one; or, with the last preview, a part. */
static int
write_png(const char *path, const struct seen *s, struct show *show,
          struct show_last *last, bool durable, struct rad_error *err)
{
    struct rad_output out = { 0 };
    struct rad_sink sink = { .write = put };
    int rc = rad_output_open(&out, path, durable, err);

    if (rc < 0)
        return rc;
    sink.arg = out.file;
    rc = last ? show_preview(show, last, &s->pic, s->known, &sink, err)
              : show_picture(show, &s->pic, s->known, &sink, err);
    if (rc == 0)
        return rad_output_commit(&out, err);
    rad_output_abort(&out);
    return rc;
}

int
picfile_write(const struct picfile *to, const uint8_t *hdr, size_t n,
              struct show *show, struct rad_error *err)
{
    struct seen s;
    int rc;

    if (!picfile_is_png(to->path, to->format))
        return rad_output_write(to->path, hdr, rad_edge_begin(hdr, n),
                                to->durable, err);
    if ((rc = see(&s, hdr, n, err)) == 0)
        rc = write_png(to->path, &s, show, NULL, to->durable, err);
    rad_picture_release(&s.pic);
    return rc;
}

int
picfile_preview(const char *path, const uint8_t *hdr, size_t n,
                struct show *show, struct show_last *last,
                struct rad_error *err)
{
    struct seen s;
    int rc = see(&s, hdr, n, err);

    if (rc == 0)
        rc = write_png(path, &s, show, last, false, err);
    rad_picture_release(&s.pic);
    return rc;
}

int
picfile_look(const uint8_t *hdr, size_t n, struct show *show,
             struct rad_error *err)
{
    struct seen s;
    int rc = see(&s, hdr, n, err);

    if (rc == 0)
        rc = show_fit(show, &s.pic, s.known, err);
    rad_picture_release(&s.pic);
    return rc;
}
