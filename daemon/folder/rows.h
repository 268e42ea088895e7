/* rows.h - the pixels of one frame on disk, and the picture made of them
 *
 * A preallocated file of width * height pixels, the top row first: four bytes
 * of RGBE each (image/hdr.h), as they will be in the picture; or floats in this
 * machine's byte order (red, green, blue radiance; distance if wanted).  Pixels
 * that have not come are zero.
 * Of the base lines that units end with the coordinator needs the exact floats;
 * these lie behind the RGBE pixels, in room for three floats of each pixel of
 * each row.  Lines that are not put take no room on the disk.
 * A ROWS_CODED file has rows that are coded as the picture's, in the order in
 * which they come; only struct rows knows their places, so such a file is of no
 * use to another process.
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

/* How pixels lie in the file; for floats the value is their number a pixel. */
enum rows_kind {
    ROWS_CODED = 1,
    ROWS_RGBE = 2,
    ROWS_COLOURS = 3, /* of jobs without MSG_JOB_CODED */
    ROWS_DISTANCES = 4
};

/* The form of a file. */
struct rows_form {
    int width, height;
    enum rows_kind kind;
    bool durable; /* all room for pixels is allocated at once, so that a full
                   * disk shows when the file is made; rows_sync() syncs the
                   * file (its name lasts when its folder is synced) */
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

/* Where a coded row lies in the file; n is 0: the row has not come. */
struct rows_place {
    uint64_t at;
    size_t n;
};

/* The files that are open, the last used first: there may be many more files
 * than a process may open.  A file is opened when it is used, and takes the
 * place of the file that was used the longest time ago.  Zeroed it is empty. */
#define ROWS_OPEN 16
struct rows_open {
    struct rows *file[ROWS_OPEN];
    struct syncs closed; /* rows and pictures that rows_sync() is to sync */
    size_t coarse_bytes; /* of the colours of all frames */
};

struct action_colours;
struct coarse;

struct rows {
    char path[ROWS_PATH_MAX];
    struct rows_open *among; /* [fixed] */
    int fd;                  /* -1: the file is closed */
    int width, height;
    enum rows_kind kind;
    bool durable;
    bool dirty; /* written to since the last sync; a dirty file is open */
    struct rows_place *place; /* ROWS_CODED: of each row; NULL: no row came */
    uint64_t end;             /* ROWS_CODED: bytes in the file */
    struct coarse *coarse;    /* colours of the frame so far, for previews;
                               * NULL: none came */
};

/* Make the file.  A durable ROWS_CODED file cannot be (RAD_EINTERNAL).
 * RAD_EFULL, RAD_ESHORT, RAD_EIO.  `among` is borrowed until rows_release(). */
int rows_create(struct rows *r, struct rows_open *among, const char *path,
                struct rows_form form, struct rad_error *err);

/* Go on with a durable file of an earlier life.  RAD_EDATA: the file is
 * missing, or has another length. */
int rows_open(struct rows *r, struct rows_open *among, const char *path,
              struct rows_form form, struct rad_error *err);

/* Write the pixels of an area, floats or RGBE as the file holds them.
 * RAD_EPROTO: the area does not lie in the picture. */
int rows_write(struct rows *r, struct rows_area a, const void *pixels,
               struct rad_error *err);

/* Write coded rows of an area, decoded unless the file is ROWS_CODED, for which
 * they must be whole rows.  *sum, unless NULL, gets their rowsum() as the file
 * holds them, of ROWS_RGBE only.  RAD_EPROTO: the area does not lie in the
 * picture, or the code is not exactly its rows. */
int rows_write_coded(struct rows *r, struct rows_area a, struct rows_code code,
                     uint64_t *sum, struct rad_error *err);

/* From now on fill pixels that have not come from these colours (coarse.h),
 * when rows are read as RGBE or made a picture.  Without room or memory the
 * colours are ignored. */
void rows_put_colours(struct rows *r, const struct action_colours *colours);
void rows_drop_colours(struct rows *r);

/* Write, read the line of row y: three floats of each pixel.  RAD_EDATA: the
 * file is not ROWS_RGBE, or has no row y. */
#define ROWS_LINE_BYTES(width) ((size_t)(width)*3 * sizeof(float))
int rows_write_line(struct rows *r, int y, const float *line,
                    struct rad_error *err);
int rows_read_line(struct rows *r, int y, float *line, struct rad_error *err);

/* Sync all of these files that were written to, and the durable pictures that
 * were made of them. */
int rows_sync(struct rows_open *among, struct rad_error *err);

/* Bytes of w pixels in the file; not of ROWS_CODED. */
size_t rows_bytes(const struct rows *r, int w);

/* Read w pixels of row y from column x on, as the file holds them; not of
 * ROWS_CODED.  RAD_EDATA: they do not lie in the picture. */
int rows_read_part(struct rows *r, int x, int y, int w, void *pixels,
                   struct rad_error *err);

/* Read whole row y. */
int rows_read(struct rows *r, int y, void *pixels, struct rad_error *err);

/* Read row y as RGBE, whatever the file holds; pixels that have not come are
 * black, or filled from colours.  work has room for ROWS_WORK_BYTES(width). */
#define ROWS_WORK_BYTES(width) RAD_HDR_ROW_BYTES(2 * (size_t)(width))
int rows_read_rgbe(struct rows *r, int y, uint8_t *rgbe, void *work,
                   struct rad_error *err);

/* A file to make of rows; it has another name until it is whole. */
struct rows_output {
    const char *path;
    bool preview;      /* a user watches the job */
    bool edges;        /* of filtered samples: what meets within pixels, too */
    bool durable;      /* the file lasts after the next rows_sync() */
    struct mark *mark; /* gets the file's mark, or is NULL */
};

/* Close a file that was made of rows, or remove it if rc < 0, the error with
 * which writing failed; durable: let rows_sync() sync it.  Returns rc, or the
 * first error here. */
int rows_close_picture(struct rows *r, struct disk_file *w, int rc,
                       bool durable, struct rad_error *err);

/* Close the file for good, and leave it on the disk. */
void rows_release(struct rows *r);

/* Close, and delete the file. */
void rows_remove(struct rows *r);

/* Open the file, unless it is open, and note that it was used last. */
int rows_use(struct rows *r, struct rad_error *err);

/* Write the RGBE picture.  info's width and height are those of the rows. */
int rows_picture(struct rows *r, const struct rad_hdr_info *info,
                 const struct rows_output *out, struct rad_error *err);

/* Write the distances, a float for each pixel of the picture: that of the
 * sample nearest to its middle, of two such samples the later; whole, with
 * oversample 1: all four floats.  RAD_EDATA: the file is not ROWS_DISTANCES. */
int rows_depth(struct rows *r, int oversample, bool whole,
               const struct rows_output *out, struct rad_error *err);

#endif
