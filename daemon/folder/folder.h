/* folder.h - the files of jobs: rows as they come, and pictures
 *
 *   make --> ID/ with "new" --noted--> ID/ --rest--> ID/ without rows
 *                   |                   |                 |
 *                   '---------------- forget -------------'
 *                                       |
 *                                    ID.gone/ --forgotten--> none
 *
 * DIR/jobs/ID/room     keeps room for frames whose rows have no file yet
 * DIR/jobs/ID/N.rows   pixels of frame N (rows.h), from the first that comes
 *                      until its picture is there
 * DIR/jobs/ID/N.hdr    the picture, N.z its distances, or the values of sensor
 *                      points, which have no picture
 * DIR/jobs/ID/cache    ambient records of passes that are closed, until the job
 *                      is over
 * DIR/jobs/ID/kept     ambient records of a job that is done, with which other
 *                      jobs may begin
 * DIR/jobs/ID/stats    statistics of a job that is over, as JSON
 * DIR/jobs/ID/new      the name of "room" until the database knows the job;
 *                      until then the submitter was not told that the job is
 *                      accepted
 * DIR/jobs/ID/over     rows of the job were given up, before the database knew
 *                      that it was cancelled: an empty file
 * DIR/jobs/ID.gone     the folder of a job that is being forgotten, until the
 *                      database does not know the job any more, or with files
 *                      that could not be removed: then ID is not made
 *
 * All calls do I/O and may wait for the disk; calls that write may be repeated
 * after RAD_EFULL.
 * Thread: one at a time. */
#ifndef DAEMON_FOLDER_H
#define DAEMON_FOLDER_H

#include "files/blobs.h"
#include "ground/disk.h"
#include "machine/action.h"
#include "folder/rows.h"
#include "machine/saved.h"

struct folder_job;

#define FOLDER_CHAINS 1024

/* Zeroed but for dir, durable and looks. */
struct folder {
    char dir[BLOBS_DIR_MAX]; /* the folder in which jobs/ lies */
    bool durable;            /* false: jobs end with the process */
    bool looks; /* take up jobs, but change no file, and leave finished files
                 * to folder_compare() */
    bool renamed; /* a job's folder was, or was made, since folder_sync() */
    /* jobs that are not over: a hash table, and a list of those that have had
     * files made since folder_sync() */
    struct folder_job *jobs[FOLDER_CHAINS], *changed;
    struct rows_open opened; /* files of their rows */
};

/* Make dir/jobs.  Without durable, forget the jobs that are there. */
int folder_init(struct folder *f, struct rad_error *err);
void folder_release(struct folder *f);

/* Make the job's folder; durable: keep room for all of its rows, too, which
 * lasts after folder_sync(), and let the folder be new until folder_noted().
 * RAD_EFULL: the disk has too little room now; RAD_EDATA: it is too small;
 * RAD_ETEMPFAIL: the job needs another id. */
int folder_make(struct folder *f, const struct msg_spec *spec,
                struct rad_error *err);
/* Go on with the files of a job of an earlier life; over: only look for its
 * pictures and statistics.  RAD_EDATA: a file is missing, or has another
 * length; RAD_EPERM: a file is denied to us. */
int folder_take_up(struct folder *f, const struct saved_job *s, bool over,
                   struct rad_error *err);
/* Read the job's finished files, and compare them with their marks; fn gets the
 * error of each file that differs or cannot be read.  RAD_ENOMEM. */
int folder_compare(struct folder *f, const struct saved_job *s, bool over,
                   void (*fn)(void *arg, const struct rad_error *why),
                   void *arg, struct rad_error *err);
bool folder_is_there(const struct folder *f, const uint8_t job[MSG_JOB]);
/* Was the job made or taken up, and is it not over? */
bool folder_is_open(struct folder *f, const uint8_t job[MSG_JOB]);
/* The database knows the job: rename "new". */
void folder_noted(const struct folder *f, const uint8_t job[MSG_JOB]);
bool folder_is_new(const struct folder *f, const uint8_t job[MSG_JOB]);
/* The job is over: remove its rows, room, cache and previews. */
void folder_rest(struct folder *f, const uint8_t job[MSG_JOB]);
/* Remove these files on a full disk, where the database cannot note yet that
 * the job was cancelled.  Until it has, and folder_rest() was called, the job
 * is given up, in other lives, too. */
void folder_give_up(struct folder *f, const uint8_t job[MSG_JOB]);
bool folder_is_given_up(const struct folder *f, const uint8_t job[MSG_JOB]);
/* Rename ID to ID.gone, and remove some of its files.  True: files are left,
 * call again.  The empty ID.gone stays until folder_forgotten() removes it, and
 * what is in it, for the database may still know the job. */
bool folder_forget(struct folder *f, const uint8_t job[MSG_JOB]);
bool folder_is_going(const struct folder *f, const uint8_t job[MSG_JOB]);
void folder_forgotten(const struct folder *f, const uint8_t job[MSG_JOB]);
/* Bytes that the job's files take on the disk, but for those that folder_rest()
 * removes. */
uint64_t folder_bytes(const struct folder *f, const uint8_t job[MSG_JOB]);

/* Pixels of rows to be put, as floats or coded. */
struct folder_pixels {
    void *bytes; /* n bytes of floats or code */
    size_t n;
    float *line; /* floats of the last of coded rows; NULL: none to keep */
};

/* Write rows.  *sum, unless NULL, gets their rowsum() as the file holds them
 * (not of ROWS_CODED).  RAD_EPROTO: the rows do not lie in the picture, have
 * other channels, or are damaged. */
int folder_put_rows(struct folder *f, const struct action_rows *key,
                    const struct folder_pixels *pixels, uint64_t *sum,
                    struct rad_error *err);
/* Fill pixels that have not come from these colours, in previews.  Colours are
 * dropped without room or memory for them. */
void folder_put_colours(struct folder *f, const uint8_t job[MSG_JOB],
                        const struct action_colours *colours);
/* Read row y, as floats of a BASE_LINE; where rows come coded it must have been
 * put as folder_pixels.line. */
int folder_read_row(struct folder *f, const uint8_t job[MSG_JOB],
                    uint32_t frame, uint32_t y, uint8_t *pixels,
                    struct rad_error *err);
/* Set *sum to the rowsum() of an area, as the file holds it; line: with the
 * last row's line, where rows come coded. */
int folder_sum(struct folder *f, const uint8_t job[MSG_JOB],
               const struct partition_area *a, bool line, uint64_t *sum,
               struct rad_error *err);
/* Keep the records of a pass, if it follows those that are kept; a pass that
 * is not kept is made again in the next life. */
void folder_put_pass(struct folder *f, const uint8_t job[MSG_JOB],
                     uint32_t pass, const struct saved_pass *p);
/* Read the kept passes of the job, *n of them, up to the first that is damaged.
 * *bytes: what pass[] points into, malloc'd, or NULL.  If they cannot be read
 * *n is 0: RAD_ESHORT, RAD_ENOMEM; RAD_EIO, RAD_EDATA. */
int folder_read_passes(struct folder *f, const uint8_t job[MSG_JOB],
                       struct saved_pass pass[MSG_MOST_PASSES], uint32_t *n,
                       uint8_t **bytes, struct rad_error *err);
/* Find the passes in the bytes of a file of passes; pass[] points into them.
 * Returns the number of bytes up to the first pass that is damaged. */
size_t folder_parse_passes(const uint8_t *bytes, size_t len,
                           struct saved_pass pass[MSG_MOST_PASSES],
                           uint32_t *n);
/* Turn the bytes of a kept cache into the records of its last stage, in place.
 * Returns the bytes of the records; FOLDER_NO_CACHE: the cache is damaged. */
#define FOLDER_NO_CACHE SIZE_MAX
size_t folder_parse_kept(uint8_t *bytes, size_t len);
/* Keep the cache of a job that is done, synced but for its new name, if all of
 * its passes are there; a second call does nothing. */
void folder_keep_cache(struct folder *f, const uint8_t job[MSG_JOB],
                       const struct pass_range *passes);
/* Bytes of the job's kept cache; 0: none is kept. */
uint64_t folder_cache_bytes(const struct folder *f, const uint8_t job[MSG_JOB]);
void folder_drop_cache(const struct folder *f, const uint8_t job[MSG_JOB]);
/* Make the records of the kept cache of job `from` the first pass of this job,
 * and sync them.  RAD_ENOINPUT: the cache is gone; RAD_EDATA: the cache is
 * damaged; RAD_EFULL, RAD_ESHORT, RAD_ENOMEM, RAD_EIO. */
int folder_reuse(struct folder *f, const uint8_t job[MSG_JOB],
                 const uint8_t from[MSG_JOB], struct rad_error *err);
/* Read the records of a first pass that folder_reuse() made: *len bytes,
 * malloc'd.  NULL: RAD_EDATA, RAD_ESHORT, RAD_ENOMEM, RAD_EIO. */
uint8_t *folder_read_first(const struct folder *f, const uint8_t job[MSG_JOB],
                           size_t *len, struct rad_error *err);
/* From now on the job's pictures have these rendering options, in place of
 * those of its specification.  RAD_ENOMEM. */
int folder_set_options(struct folder *f, const uint8_t job[MSG_JOB],
                       const char *options, struct rad_error *err);
/* Sync all rows and pictures that were written, their files' names, and the
 * names of folders that folder_forget() changed. */
int folder_sync(struct folder *f, struct rad_error *err);

/* Write a frame's picture, if the job has pictures, and its distances; durable:
 * both last after folder_sync().  *marks, unless NULL, gets their marks. */
int folder_picture(struct folder *f, const uint8_t job[MSG_JOB], uint32_t frame,
                   struct saved_frame *marks, struct rad_error *err);
/* Remove a frame's rows, once it is noted that its picture is there. */
void folder_drop_rows(struct folder *f, const uint8_t job[MSG_JOB],
                      uint32_t frame);
/* Write the job's statistics; durable: they last after folder_sync().  *mark
 * gets their mark. */
int folder_stats(struct folder *f, const uint8_t job[MSG_JOB], const char *text,
                 size_t len, struct mark *mark, struct rad_error *err);

/* Set path to the file of a picture, of distances, statistics or a preview;
 * make: write the preview first, or RAD_ETEMPFAIL if the disk is full.  A frame
 * without rows has its picture for a preview. */
int folder_find(struct folder *f, const uint8_t job[MSG_JOB], uint32_t frame,
                enum msg_what what, bool make, char path[DISK_PATH_MAX],
                struct rad_error *err);

/* Call fn for each job that has a folder, until fn returns other than 0; going:
 * the job is being forgotten. */
typedef int folder_fn(void *arg, const uint8_t job[MSG_JOB], bool going,
                      struct rad_error *err);
int folder_each(const struct folder *f, folder_fn *fn, void *arg,
                struct rad_error *err);

#endif
