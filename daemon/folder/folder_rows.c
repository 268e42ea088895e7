/* folder_rows.c - rows of jobs that are not over: written, read, synced
 *
 * A frame's file is made when its first row comes.  If jobs last, room for the
 * file was kept since the job was accepted. */
#include "config.h"

#include "folder/folder_impl.h"

#include "folder/room.h"
#include "machine/rowsum.h"

#include <stdio.h>
#include <stdlib.h>

/* Make the file of a frame's rows, in place of the room that was kept for it.
 */
static int
begin_frame(struct folder *f, struct folder_job *j, uint32_t i,
            struct rad_error *err)
{
    struct frame_rows *r = &j->frames[i];
    struct rows_form form = { r->width, r->height, j->kind, f->durable };
    uint64_t room = f->durable ? j->room - folder_frame_bytes(j, r) : 0;
    char path[DISK_PATH_MAX];
    int rc = 0;

    r->rows = calloc(1, sizeof *r->rows);
    if (!r->rows)
        return rad_fail_memory(err);
    if (f->durable) {
        folder_path(f, j->id, FOLDER_ROOM, path);
        rc = room_set(path, room, err);
    }
    folder_frame_path(f, j->id, i, ".rows", path);
    if (rc == 0)
        rc = rows_create(r->rows, &f->opened, path, form, err);
    if (rc < 0) {
        free(r->rows);
        r->rows = NULL;
        return rc;
    }
    j->room = room;
    if (!j->new_files) {
        j->changed = f->changed;
        f->changed = j;
    }
    j->new_files = true;
    r->file = FILE_ROWS;
    return 0;
}

int
folder_find_rows(struct folder *f, const uint8_t *id, uint32_t frame,
                 struct folder_job **job, struct frame_rows **rows,
                 struct rad_error *err)
{
    struct folder_job *j = *folder_find_job(f, id);
    int rc = 0;

    *rows = NULL;
    if (!j || frame >= j->nframes || j->frames[frame].file == FILE_PICTURE)
        return rad_fail(err, RAD_ENOINPUT, "no rows of frame %u", frame);
    if (j->frames[frame].file == FILE_NONE)
        rc = begin_frame(f, j, frame, err);
    if (rc < 0)
        return rc;
    if (job)
        *job = j;
    *rows = &j->frames[frame];
    return 0;
}

void
folder_drop_rows(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame)
{
    struct folder_job *j = *folder_find_job(f, id);
    struct frame_rows *r = j && frame < j->nframes ? &j->frames[frame] : NULL;

    if (!r || r->file != FILE_ROWS)
        return;
    rows_remove(r->rows);
    folder_free_rows(r);
    r->file = FILE_PICTURE;
}

static int
put_coded(struct rows *r, struct rows_area a, const struct folder_pixels *p,
          uint64_t *sum, struct rad_error *err)
{
    int last = a.y + a.h - 1;
    int rc =
        rows_write_coded(r, a, (struct rows_code){ p->bytes, p->n }, sum, err);

    if (rc == 0 && p->line)
        rc = rows_write_line(r, last, p->line, err);
    if (rc == 0 && p->line && sum)
        *sum ^= rowsum(p->line, ROWS_LINE_BYTES(r->width), (uint32_t)last, 1);
    return rc;
}

int
folder_put_rows(struct folder *f, const struct action_rows *k,
                const struct folder_pixels *p, uint64_t *sum,
                struct rad_error *err)
{
    struct rows_area area = { (int)k->x, (int)k->y, (int)k->width,
                              (int)k->rows };
    struct frame_rows *r;
    int rc = folder_find_rows(f, k->job, k->frame, NULL, &r, err);

    if (rc < 0)
        return rc;
    if (k->channels == 1)
        return put_coded(r->rows, area, p, sum, err);
    if (k->channels != (int)r->rows->kind)
        return rad_fail(err, RAD_EPROTO, "rows of %d channels, expected %d",
                        k->channels, (int)r->rows->kind);
    rc = rows_write(r->rows, area, p->bytes, err);
    if (rc == 0 && sum)
        *sum = rowsum(p->bytes, p->n / k->rows, k->y, k->rows);
    return rc;
}

void
folder_put_colours(struct folder *f, const uint8_t id[MSG_JOB],
                   const struct action_colours *colours)
{
    struct rad_error ignored = { 0 };
    struct frame_rows *r;

    if (folder_find_rows(f, id, colours->frame, NULL, &r, &ignored) == 0)
        rows_put_colours(r->rows, colours);
}

int
folder_read_row(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
                uint32_t y, uint8_t *pixels, struct rad_error *err)
{
    struct frame_rows *r;
    int rc = folder_find_rows(f, id, frame, NULL, &r, err);
    bool line;
    float *row;
    size_t n;

    if (rc < 0)
        return rc;
    line = r->rows->kind == ROWS_RGBE;
    n = line ? ROWS_LINE_BYTES(r->rows->width)
             : rows_bytes(r->rows, r->rows->width);
    row = malloc(n);
    if (!row)
        return rad_fail_memory(err);
    rc = line ? rows_read_line(r->rows, (int)y, row, err)
              : rows_read(r->rows, (int)y, row, err);
    if (rc == 0)
        wire_floats_put(pixels, row, n / sizeof *row);
    free(row);
    return rc;
}

/* Add the rowsum() of row y's line to *sum. */
static int
sum_line(struct rows *r, uint32_t y, uint64_t *sum, struct rad_error *err)
{
    float *line = malloc(ROWS_LINE_BYTES(r->width));
    int rc = line ? rows_read_line(r, (int)y, line, err) : rad_fail_memory(err);

    if (rc == 0)
        *sum ^= rowsum(line, ROWS_LINE_BYTES(r->width), y, 1);
    free(line);
    return rc;
}

int
folder_sum(struct folder *f, const uint8_t id[MSG_JOB],
           const struct partition_area *a, bool line, uint64_t *sum,
           struct rad_error *err)
{
    struct frame_rows *r;
    int rc = folder_find_rows(f, id, a->frame, NULL, &r, err);
    void *row;
    size_t n;

    *sum = 0;
    if (rc < 0)
        return rc;
    n = rows_bytes(r->rows, (int)a->width);
    row = malloc(n);
    if (!row)
        return rad_fail_memory(err);
    for (uint32_t i = 0; i < a->height && rc == 0; i++) {
        rc = rows_read_part(r->rows, (int)a->x, (int)(a->y + i), (int)a->width,
                            row, err);
        if (rc == 0)
            *sum ^= rowsum(row, n, a->y + i, 1);
    }
    free(row);
    if (rc == 0 && line && a->height > 0 && r->rows->kind == ROWS_RGBE)
        rc = sum_line(r->rows, a->y + a->height - 1, sum, err);
    return rc;
}

int
folder_sync(struct folder *f, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc = rows_sync(&f->opened, err);

    while (f->changed && rc == 0) {
        struct folder_job *j = f->changed;

        folder_path(f, j->id, "", path);
        rc = disk_sync_path(path, err);
        if (rc == 0) {
            j->new_files = false;
            f->changed = j->changed;
        }
    }
    if (rc == 0 && f->renamed) {
        snprintf(path, sizeof path, "%s/jobs", f->dir);
        rc = disk_sync_path(path, err);
        f->renamed = rc < 0;
    }
    return rc;
}
