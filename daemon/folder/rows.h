/* rows.h - the pixels of one frame on disk, and the picture made of them
 *
 * A preallocated file of width * height pixels, the top row first: four bytes
 * of RGBE each (image/hdr.h), as they will be in the picture; or, where
 * distances are wanted, four floats (red, green, blue radiance, distance) in
 * the machine's own byte order: it is read by nobody else.  What has not come
 * is zero.
 * What RGBE cannot give back a coordinator needs of a few rows, the base lines
 * that units end with: all three floats of each pixel of these lie behind the
 * pixels, at the same place in order.  What was not put there takes no room.
 * Or, in ROWS_CODED, rows that are coded as the picture's, one behind the
 * other as they come; where each lies is remembered here, so such a file is
 * good for this process only.
 * All calls do I/O and may wait for the disk.
 * Thread: one at a time. */
#ifndef RADD_DAEMON_ROWS_H
#define RADD_DAEMON_ROWS_H

#include "ground/disk.h"
#include "ground/mark.h"
#include "ground/syncs.h"
#include "image/hdr.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ROWS_PATH_MAX 1280

/* How pixels lie in the file; of floats the value is their number a pixel. */
enum rows_kind {
    ROWS_CODED = 1,
    ROWS_RGBE = 2,
    ROWS_COLOURS = 3, /* of jobs without MSG_JOB_CODED */
    ROWS_DISTANCES = 4
};

/* What a file is made for. */
struct rows_form {
    int width, height;
    enum rows_kind kind;
    bool durable; /* it has all its space on the disk, so that a full one shows
                   * when it is made, and lasts as soon as what is written to
                   * it does (its name, when its folder is synced) */
};

/* Pixels of the frame: w columns from x on of h rows from y on. */
struct rows_area {
    int x, y, w, h;
};

/* Rows that are coded one behind the other (rad_hdr_encode_row()); borrowed. */
struct rows_code {
    const uint8_t *bytes;
    size_t n;
};

/* Where a coded row lies in the file; n is 0: it has not come. */
struct rows_place {
    uint64_t at;
    size_t n;
};

/* The files that are open, the one used last first: there may be many more
 * than a process may open.  A file is opened when it is used; another then
 * has to make room.  Zeroed it is empty. */
#define ROWS_OPEN 16
struct rows_open {
    struct rows *file[ROWS_OPEN];
    struct syncs closed; /* of rows and pictures, which are to last */
    size_t coarse_bytes; /* of the colours of all frames */
};

struct action_colours;
struct coarse;

struct rows {
    char path[ROWS_PATH_MAX];
    struct rows_open *among; /* [fixed] */
    int fd;                  /* -1: it is not open */
    int width, height;
    enum rows_kind kind;
    bool durable;
    bool dirty; /* written to since it was last synced; then it is open */
    struct rows_place *place; /* of ROWS_CODED: height; NULL: none came */
    uint64_t end;             /* of what they take */
    struct coarse *coarse;    /* what the frame looks like so far, for previews;
                               * NULL: nothing tells */
};

/* Make the file.  ROWS_CODED has no durable file (RAD_EINTERNAL).  RAD_EFULL,
 * RAD_ESHORT, RAD_EIO. */
int rows_create(struct rows *r, struct rows_open *among, const char *path,
                struct rows_form form, struct rad_error *err);

/* The same file, a durable one, as it was left; RAD_EDATA when it is missing,
 * or not as long. */
int rows_open(struct rows *r, struct rows_open *among, const char *path,
              struct rows_form form, struct rad_error *err);

/* Put the pixels of an area, as in the file, which holds floats or RGBE.
 * RAD_EPROTO if they do not lie in the picture. */
int rows_write(struct rows *r, struct rows_area a, const void *pixels,
               struct rad_error *err);

/* The same of coded rows, of which only a few are taken apart at a time; in
 * ROWS_CODED they must be whole rows.  Where sum is not NULL it gets their
 * rowsum(), as they are in the file, of ROWS_RGBE.  RAD_EPROTO also for what is
 * not so many rows, or none. */
int rows_write_coded(struct rows *r, struct rows_area a, struct rows_code code,
                     uint64_t *sum, struct rad_error *err);

/* What has not come is filled from these colours (coarse.h) from now on, where
 * the rows are read as RGBE or made a picture; without room or memory it is
 * not. */
void rows_put_colours(struct rows *r, const struct action_colours *colours);
void rows_drop_colours(struct rows *r);

/* Put, get the three floats of each pixel of row y; of ROWS_RGBE alone. */
#define ROWS_LINE_BYTES(width) ((size_t)(width)*3 * sizeof(float))
int rows_write_line(struct rows *r, int y, const float *line,
                    struct rad_error *err);
int rows_read_line(struct rows *r, int y, float *line, struct rad_error *err);

/* Wait until what was written to any of these files is on the disk, and the
 * pictures that were made of them. */
int rows_sync(struct rows_open *among, struct rad_error *err);

/* Bytes of w pixels in the file; not of ROWS_CODED. */
size_t rows_bytes(const struct rows *r, int w);

/* Read w pixels of row y from column x on, as they are in the file; not of
 * ROWS_CODED.  RAD_EDATA if they do not lie in the picture. */
int rows_read_part(struct rows *r, int x, int y, int w, void *pixels,
                   struct rad_error *err);

/* Read whole row y. */
int rows_read(struct rows *r, int y, void *pixels, struct rad_error *err);

/* Row y as it is in a picture, four bytes a pixel, whatever the file holds;
 * what has not come is black, or of its colours. work has room for
 * ROWS_WORK_BYTES(width). */
#define ROWS_WORK_BYTES(width) RAD_HDR_ROW_BYTES(2 * (size_t)(width))
int rows_read_rgbe(struct rows *r, int y, uint8_t *rgbe, void *work,
                   struct rad_error *err);

/* Where what is made of rows is written: whole, under another name until then.
 */
struct rows_output {
    const char *path;
    bool preview;      /* for somebody who watches */
    bool durable;      /* it lasts after the next rows_sync() */
    struct mark *mark; /* gets what was written, or is NULL */
};

/* Close what was made of them, rc being what came of that. */
int rows_close_picture(struct rows *r, struct disk_file *w, int rc,
                       bool durable, struct rad_error *err);

/* Close the file for good; it is left where it is. */
void rows_release(struct rows *r);

/* Close, and delete the file. */
void rows_remove(struct rows *r);

/* Open the file if it was closed to make place for others. */
int rows_use(struct rows *r, struct rad_error *err);

/* Make the RGBE picture.  info's width and height are those of the rows. */
int rows_picture(struct rows *r, const struct rad_hdr_info *info,
                 const struct rows_output *out, struct rad_error *err);

/* The same of the distances, a float for each pixel of the picture: that of the
 * sample nearest to its middle, of several the last; or with `whole` the
 * samples as they are, four floats each.  Needs ROWS_DISTANCES. */
int rows_depth(struct rows *r, int oversample, bool whole,
               const struct rows_output *out, struct rad_error *err);

#endif
