/* folder_take.c - the folders of jobs of earlier lives
 *
 * Finished files are compared with their marks.  In a job that is not over a
 * frame of which the database notes rows must have its file; other frames may
 * have one.  The job's room is then set to what frames without a file need.  A
 * job that was given up needs neither rows nor room. */
#include "config.h"

#include "folder/folder_impl.h"

#include "folder/room.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- finished files --- */

/* A finished file of the job, and its mark. */
typedef int finished_fn(void *arg, const struct mark *m, const char *path,
                        struct rad_error *err);

/* Call fn for the picture of a frame that is written, and its distances; for
 * the values of sensor points. */
static int
each_of_frame(const struct folder *f, const struct saved_job *s, uint32_t i,
              finished_fn *fn, void *arg, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc = 0;

    folder_frame_path(f, s->spec.job, i, folder_suffix_of(MSG_WHAT_PICTURE),
                      path);
    if (!(s->spec.flags & MSG_JOB_POINTS))
        rc = fn(arg, &s->frames[i].picture, path, err);
    if (rc < 0 || !(s->spec.flags & MSG_JOB_DEPTH))
        return rc;
    folder_frame_path(f, s->spec.job, i, folder_suffix_of(MSG_WHAT_DEPTH),
                      path);
    return fn(arg, &s->frames[i].depth, path, err);
}

/* Call fn for all finished files of the job; over: for its statistics, too. */
static int
each_finished(const struct folder *f, const struct saved_job *s, bool over,
              finished_fn *fn, void *arg, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc = 0;

    for (uint32_t i = 0; i < s->spec.nframes && rc == 0; i++)
        if (s->frames[i].written)
            rc = each_of_frame(f, s, i, fn, arg, err);
    if (rc < 0 || !over)
        return rc;
    folder_path(f, s->spec.job, FOLDER_STATS, path);
    return fn(arg, &s->stats, path, err);
}

static int
look_at_size(void *arg, const struct mark *m, const char *path,
             struct rad_error *err)
{
    (void)arg;
    return mark_look(m, path, false, err);
}

struct comparison {
    void (*fn)(void *arg, const struct rad_error *why);
    void *arg;
};

static int
look_at_bytes(void *arg, const struct mark *m, const char *path,
              struct rad_error *err)
{
    const struct comparison *c = arg;
    struct rad_error why = { 0 };
    int rc = mark_look(m, path, true, &why);

    if (rc == RAD_ENOMEM)
        return rad_fail(err, rc, "%s", why.what);
    if (rc < 0)
        c->fn(c->arg, &why);
    return 0;
}

int
folder_compare(struct folder *f, const struct saved_job *s, bool over,
               void (*fn)(void *arg, const struct rad_error *why), void *arg,
               struct rad_error *err)
{
    struct comparison c = { fn, arg };

    return each_finished(f, s, over, look_at_bytes, &c, err);
}

/* --- rows --- */

/* Which frames have a file of rows (there), and which must have one (noted). */
struct found {
    bool *there, *noted;
};

static int
look_for_rows(const struct folder *f, const struct saved_job *s,
              struct found *to, struct rad_error *err)
{
    char path[DISK_PATH_MAX], *end;
    struct dirent *e;
    DIR *d;

    for (uint32_t i = 0; i < s->nunits; i++)
        to->noted[s->units[i].area.frame] |= s->units[i].stored > 0;
    folder_path(f, s->spec.job, "", path);
    d = disk_open_dir(path);
    if (!d)
        return errno == ENOENT ? 0 : disk_fail(err, errno, "open", path);
    while ((e = readdir(d)) != NULL) {
        unsigned long n = strtoul(e->d_name, &end, 10);

        if (end > e->d_name && strcmp(end, ".rows") == 0 && n < s->spec.nframes)
            to->there[n] = true;
    }
    closedir(d);
    return 0;
}

/* Open a frame's file of rows.  If no rows of the frame are noted, the file may
 * be half made; then it is removed, and made anew later. */
static int
take_rows(struct folder *f, struct folder_job *j, uint32_t i, bool noted,
          struct rad_error *err)
{
    struct frame_rows *r = &j->frames[i];
    struct rows_form form = { r->width, r->height, j->kind, true };
    struct rad_error why = { 0 };
    char path[DISK_PATH_MAX];

    r->rows = calloc(1, sizeof *r->rows);
    if (!r->rows)
        return rad_fail_memory(err);
    folder_frame_path(f, j->id, i, ".rows", path);
    if (rows_open(r->rows, &f->opened, path, form, &why) == 0) {
        r->file = FILE_ROWS;
        return 0;
    }
    free(r->rows);
    r->rows = NULL;
    if (noted || why.code != RAD_EDATA)
        return rad_fail(err, why.code, "%s", why.what);
    if (!f->looks)
        unlink(path);
    return 0;
}

static int
take_frames(struct folder *f, struct folder_job *j, const struct saved_job *s,
            const struct found *found, struct rad_error *err)
{
    bool given_up = folder_is_given_up(f, j->id);
    int rc = 0;

    for (uint32_t i = 0; i < j->nframes && rc == 0; i++) {
        struct frame_rows *r = &j->frames[i];
        bool noted = found->noted[i] && !given_up;

        if (s->frames[i].written)
            r->file = FILE_PICTURE;
        else if (found->there[i] || noted)
            rc = take_rows(f, j, i, noted, err);
        if (r->file == FILE_NONE && !given_up)
            j->room += folder_frame_bytes(j, r);
    }
    return rc;
}

static int
take_open(struct folder *f, struct folder_job *j, const struct saved_job *s,
          struct rad_error *err)
{
    struct found found = { calloc(j->nframes + 1, sizeof(bool)),
                           calloc(j->nframes + 1, sizeof(bool)) };
    struct rad_error why = { 0 };
    char path[DISK_PATH_MAX];
    int rc;

    if (!found.there || !found.noted)
        rc = rad_fail_memory(err);
    else
        rc = look_for_rows(f, s, &found, err);
    if (rc == 0)
        rc = take_frames(f, j, s, &found, err);
    free(found.there);
    free(found.noted);
    if (rc < 0 || f->looks)
        return rc;
    folder_noted(f, j->id);
    /* if the disk is full now, the job is held when its rows need more room */
    folder_path(f, j->id, FOLDER_ROOM, path);
    rc = room_set(path, j->room, &why);
    return rc == 0 || rc == RAD_EFULL ? 0 : rad_fail(err, rc, "%s", why.what);
}

int
folder_take_up(struct folder *f, const struct saved_job *s, bool over,
               struct rad_error *err)
{
    struct folder_job *j = folder_new_job(f, &s->spec, err);
    char path[DISK_PATH_MAX];
    int rc = 0;

    if (!j)
        return RAD_ENOMEM;
    folder_path(f, s->spec.job, "", path);
    if (access(path, R_OK | W_OK | X_OK) < 0)
        rc = mark_missing(path, errno, err);
    if (rc == 0 && !f->looks) /* else folder_compare() tells of each file */
        rc = each_finished(f, s, over, look_at_size, NULL, err);
    if (rc == 0 && !over)
        rc = take_open(f, j, s, err);
    if (rc < 0 || over)
        folder_free_job(j);
    else
        folder_add_job(f, j);
    return rc;
}
