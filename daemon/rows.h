/* rows.h - the pixels of one frame on disk, and the picture made of them
 *
 * A preallocated file of width * height pixels, the top row first, each
 * `channels` floats (red, green, blue radiance, and the distance with -z) in
 * the machine's own byte order: it is read by nobody else.  What has not
 * come is zero.
 * Or, with channels 1, rows that are coded as the picture's, one behind the
 * other as they come; where each lies is remembered here, so such a file is
 * good for this process only.
 * All calls do I/O and may wait for the disk.
 * Thread: one at a time. */
#ifndef RADD_DAEMON_ROWS_H
#define RADD_DAEMON_ROWS_H

#include "base/error.h"
#include "picture/hdr.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ROWS_PATH_MAX 1280

/* Where a coded row lies in the file; n is 0: it has not come. */
struct rows_place {
    uint64_t at;
    size_t n;
};

struct rows {
    char path[ROWS_PATH_MAX];
    int fd; /* -1 while nothing has used it: it is opened when needed */
    int width, height, channels; /* channels is 3 or 4; 1: coded */
    bool dirty;                  /* written to since the last rows_sync() */
    struct rows_place *place;    /* of coded ones: height; NULL: none came */
    uint64_t end;                /* of what they take */
};

/* Make the file; durable: it has all its space on the disk, so that a full one
 * shows here, and lasts (its name does when its folder is synced).  Coded rows
 * have no durable file (RAD_EINTERNAL).  RAD_EFULL, RAD_EIO. */
int rows_create(struct rows *r, const char *path, int width, int height,
                int channels, bool durable, struct rad_error *err);

/* The same file as it was left; RAD_EDATA when it is missing, or not as long.
 */
int rows_open(struct rows *r, const char *path, int width, int height,
              int channels, struct rad_error *err);

/* Put h rows of w pixels at column x, row y; pixels is w * h * channels
 * floats.  RAD_EPROTO if they do not lie in the picture. */
int rows_write(struct rows *r, int x, int y, int w, int h, const float *pixels,
               struct rad_error *err);

/* Put h whole rows at row y, coded one behind the other in n bytes.  RAD_EPROTO
 * if they do not lie in the picture, or are not so many. */
int rows_write_coded(struct rows *r, int y, int h, const void *code, size_t n,
                     struct rad_error *err);

/* Wait until what was written is on the disk. */
int rows_sync(struct rows *r, struct rad_error *err);

/* Read w pixels of row y from column x on; not of coded ones.  RAD_EDATA if
 * they do not lie in the picture. */
int rows_read_part(struct rows *r, int x, int y, int w, float *pixels,
                   struct rad_error *err);

/* Read whole row y into width * channels floats; not of coded ones. */
int rows_read(struct rows *r, int y, float *pixels, struct rad_error *err);

/* Close the file for now. */
void rows_rest(struct rows *r);

/* Close it for good; it is left where it is. */
void rows_release(struct rows *r);

/* Close, and delete the file. */
void rows_remove(struct rows *r);

/* Make the RGBE picture at path, whole: temporary file, fsync if durable,
 * rename.  info's width and height are those of the rows. */
int rows_picture(struct rows *r, const struct rad_hdr_info *info,
                 const char *path, bool durable, struct rad_error *err);

/* The same of the distances: width * height floats; needs 4 channels. */
int rows_depth(struct rows *r, const char *path, bool durable,
               struct rad_error *err);

#endif
