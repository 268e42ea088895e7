/* folder_picture.c - pictures, distances and previews from rows; statistics */
#include "config.h"

#include "folder/folder_impl.h"

#include "folder/filtered.h"
#include "machine/jobtext.h"

#include <stdlib.h>
#include <string.h>

/* Write a picture of the rows that are there. */
static int
write_rgbe(const struct folder_job *j, struct frame_rows *f,
           const struct rows_output *out, struct rad_error *err)
{
    struct rad_hdr_info info = { .origin = j->origin,
                                 .software = "radd " PACKAGE_VERSION,
                                 .program = "radsubmit",
                                 .options = j->params,
                                 .view = f->view,
                                 .frame = f->number,
                                 .width = f->width,
                                 .height = f->height };
    char options[RAD_FILTER_OPTIONS];
    struct rad_filter_shape shape;
    int rc = jobtext_pixaspect(j->params, f->view, f->width, f->height,
                               &info.pixaspect, err);

    if (rc < 0)
        return rc;
    if (j->oversample == 1)
        return rows_picture(f->rows, &info, out, err);
    rc = filtered_shape(&shape, f->width, f->height, j->oversample, j->clamp,
                        f->view, err);
    if (rc == 0)
        rc = jobtext_options(j->params, j->oversample, j->clamp, options, err);
    if (rc < 0)
        return rc;
    info.options = options;
    info.width = rad_filter_side(f->width, j->oversample);
    info.height = rad_filter_side(f->height, j->oversample);
    info.pixaspect = rad_filter_pixaspect(&shape, info.pixaspect);
    return filtered_picture(f->rows, &shape, &info, out, err);
}

int
folder_set_options(struct folder *f, const uint8_t id[MSG_JOB],
                   const char *options, struct rad_error *err)
{
    struct folder_job *j = *folder_find_job(f, id);
    char *copy;

    if (!j)
        return 0;
    copy = strdup(options);
    if (!copy)
        return rad_fail_memory(err);
    free(j->params);
    j->params = copy;
    return 0;
}

int
folder_picture(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
               struct saved_frame *marks, struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;
    char path[DISK_PATH_MAX];
    struct rows_output out = { .path = path, .durable = f->durable };
    int rc = folder_find_rows(f, id, frame, &j, &r, err);

    if (rc == 0) /* the frame is whole, and needs no colours */
        rows_drop_colours(r->rows);
    if (rc == 0 && j->depth) {
        folder_frame_path(f, id, frame, folder_suffix_of(MSG_WHAT_DEPTH), path);
        out.mark = marks ? &marks->depth : NULL;
        rc = rows_depth(r->rows, j->oversample, j->points, &out, err);
    }
    if (rc < 0 || j->points) /* nobody asks for a picture of points */
        return rc;
    folder_frame_path(f, id, frame, folder_suffix_of(MSG_WHAT_PICTURE), path);
    out.mark = marks ? &marks->picture : NULL;
    out.edges = j->edges;
    return write_rgbe(j, r, &out, err);
}

int
folder_stats(struct folder *f, const uint8_t id[MSG_JOB], const char *text,
             size_t len, struct mark *mark, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct disk_file w;
    int rc;

    folder_path(f, id, FOLDER_STATS, path);
    rc = disk_file_open(&w, path, mark, err);
    if (rc < 0)
        return rc;
    rc = disk_file_write(&w, text, len, err);
    rc = disk_file_close(&w, rc, err);
    if (rc == 0 && f->durable)
        rc = syncs_add(&f->opened.closed, path, true, err);
    return rc;
}

/* Make a preview.  On a full disk there is none, for what is asked for later
 * would have to wait for it: pictures of jobs that make room by being fetched.
 */
static int
make_preview(struct folder_job *j, struct frame_rows *r, const char *path,
             struct rad_error *err)
{
    struct rows_output out = { .path = path, .preview = true };
    struct rad_error why = { 0 };
    int rc = write_rgbe(j, r, &out, &why);

    if (rc == RAD_EFULL)
        rc = RAD_ETEMPFAIL;
    return rc < 0 ? rad_fail(err, rc, "%s", why.what) : 0;
}

int
folder_find(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
            enum msg_what what, bool make, char path[DISK_PATH_MAX],
            struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct frame_rows *r;
    struct folder_job *j;
    int rc;

    if (what == MSG_WHAT_STATS) {
        folder_path(f, id, FOLDER_STATS, path);
        return 0;
    }
    if (what != MSG_WHAT_PREVIEW) {
        folder_frame_path(f, id, frame, folder_suffix_of(what), path);
        return 0;
    }
    rc = folder_find_rows(f, id, frame, &j, &r, &why);
    if (rc == RAD_ENOINPUT) { /* no rows: the picture is the preview */
        folder_frame_path(f, id, frame, folder_suffix_of(MSG_WHAT_PICTURE),
                          path);
        return 0;
    }
    if (rc < 0)
        return rad_fail(err, rc, "%s", why.what);
    folder_frame_path(f, id, frame, folder_suffix_of(what), path);
    return make ? make_preview(j, r, path, err) : 0;
}
