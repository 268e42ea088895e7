/* folder.h - the files of jobs: rows as they come, and pictures
 *
 * DIR/jobs/ID/room     room that is kept for frames whose rows have no file yet
 * DIR/jobs/ID/N.rows   pixels of frame N (rows.h), from the first that comes
 *                      until its picture is there
 * DIR/jobs/ID/N.hdr    the picture, N.z its distances
 * DIR/jobs/ID/cache    ambient records of passes that are closed, until the job
 *                      is over
 * DIR/jobs/ID/kept     the same of a job that is done, for other jobs to begin
 *                      with
 * DIR/jobs/ID/stats    statistics of a job that is over, as JSON
 * DIR/jobs/ID/new      until the database knows the job: nobody was told that
 *                      it is accepted
 * DIR/jobs/ID.gone     what was the folder of a job that is forgotten, empty,
 *                      until the database does not know it any more
 *
 * All calls do I/O and may wait for the disk; what writes may be called again
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

/* Zeroed but for dir, durable and looks. */
struct folder {
    char dir[BLOBS_DIR_MAX]; /* of all: that in which jobs/ lies */
    bool durable;
    bool looks;              /* takes up jobs, and changes nothing */
    struct folder_job *jobs; /* that are not over */
    struct rows_open opened; /* of their rows */
};

/* Make dir/jobs.  Without durable, jobs that are there go. */
int folder_init(struct folder *f, struct rad_error *err);
void folder_release(struct folder *f);

/* Make the job's folder and room for its rows; durable: they last, and the
 * folder is new until folder_noted().  RAD_EFULL when there is not so much room
 * now, RAD_EDATA when there never will be. */
int folder_make(struct folder *f, const struct msg_spec *spec,
                struct rad_error *err);
/* Go on with the files that are there: RAD_EDATA for those that are missing, or
 * not as long as they should be, RAD_EPERM for those that are denied to us.
 * over: only its pictures and statistics are looked for. */
int folder_take_up(struct folder *f, const struct saved_job *s, bool over,
                   struct rad_error *err);
/* Read what is finished of the job, and compare it with its marks; fn gets the
 * error of each file that is another.  RAD_ENOMEM. */
int folder_compare(struct folder *f, const struct saved_job *s, bool over,
                   void (*fn)(void *arg, const struct rad_error *why),
                   void *arg, struct rad_error *err);
bool folder_is_there(const struct folder *f, const uint8_t job[MSG_JOB]);
/* Does the job go on? */
bool folder_is_open(struct folder *f, const uint8_t job[MSG_JOB]);
/* The database knows the job: the folder is not new any more. */
void folder_noted(const struct folder *f, const uint8_t job[MSG_JOB]);
bool folder_is_new(const struct folder *f, const uint8_t job[MSG_JOB]);
/* The job is over: rows that are left go. */
void folder_rest(struct folder *f, const uint8_t job[MSG_JOB]);
/* All of it goes: at once, or not at all; but of its files so many at a time as
 * take no long while, and true tells that there are more.  Its name as one that
 * is gone stays until the other is called, too. */
bool folder_forget(struct folder *f, const uint8_t job[MSG_JOB]);
bool folder_is_going(const struct folder *f, const uint8_t job[MSG_JOB]);
void folder_forgotten(const struct folder *f, const uint8_t job[MSG_JOB]);
/* Bytes that its files take. */
uint64_t folder_bytes(const struct folder *f, const uint8_t job[MSG_JOB]);

/* Pixels of rows to be put, as the file holds them or coded. */
struct folder_pixels {
    void *bytes; /* n bytes of floats or code */
    size_t n;
    float *line; /* of coded rows: the last one's floats; NULL: none to keep */
};

/* Where sum is not NULL it gets their rowsum(), as they are in the file.
 * RAD_EPROTO when they do not lie in the picture. */
int folder_put_rows(struct folder *f, const struct action_rows *key,
                    const struct folder_pixels *pixels, uint64_t *sum,
                    struct rad_error *err);
/* For previews: what rows have not come of a frame is filled from such colours.
 * Those for which there is no room or memory are left out. */
void folder_put_colours(struct folder *f, const uint8_t job[MSG_JOB],
                        const struct action_colours *colours);
/* Row y, as in a BASE_LINE; of coded ones it must have been put as a line. */
int folder_read_row(struct folder *f, const uint8_t job[MSG_JOB],
                    uint32_t frame, uint32_t y, uint8_t *pixels,
                    struct rad_error *err);
/* rowsum() of the first rows of an area, as they are in the file; line: that of
 * the last of them was put, too. */
int folder_sum(struct folder *f, const uint8_t job[MSG_JOB],
               const struct partition_area *a, uint32_t rows, bool line,
               uint64_t *sum, struct rad_error *err);
/* Keep the records of a pass, if they follow those that are kept; what cannot
 * be kept is made again. */
void folder_put_pass(struct folder *f, const uint8_t job[MSG_JOB],
                     uint32_t pass, const struct saved_pass *p);
/* The passes of the job that are kept, *n of them, as far as they are sound.
 * Returns the bytes that pass[] points into, malloc'd, or NULL. */
uint8_t *folder_read_passes(struct folder *f, const uint8_t job[MSG_JOB],
                            struct saved_pass pass[MSG_MOST_PASSES],
                            uint32_t *n);
/* The same of the bytes of such a file, which are lent; returns how many of the
 * bytes are sound, from the first. */
size_t folder_parse_passes(const uint8_t *bytes, size_t len,
                           struct saved_pass pass[MSG_MOST_PASSES],
                           uint32_t *n);
/* The bytes of a cache that is kept, put together to records alone, in place:
 * how many bytes these have, or FOLDER_NO_CACHE when it is damaged. */
#define FOLDER_NO_CACHE SIZE_MAX
size_t folder_parse_kept(uint8_t *bytes, size_t len);
/* The job is done: keep its cache, if all of its passes are there; it may have
 * been called before. */
void folder_keep_cache(struct folder *f, const uint8_t job[MSG_JOB],
                       const struct pass_range *passes);
/* Bytes of the cache that is kept of the job; 0: none is. */
uint64_t folder_cache_bytes(const struct folder *f, const uint8_t job[MSG_JOB]);
void folder_drop_cache(const struct folder *f, const uint8_t job[MSG_JOB]);
/* The records of the cache that is kept of another job are the first pass of
 * this one, for good: RAD_ENOINPUT when that cache is gone, RAD_EDATA when it
 * is damaged, RAD_EFULL, RAD_ESHORT, RAD_EIO. */
int folder_reuse(struct folder *f, const uint8_t job[MSG_JOB],
                 const uint8_t from[MSG_JOB], struct rad_error *err);
/* The records of a first pass that came by folder_reuse(), *len bytes,
 * malloc'd; NULL: RAD_EDATA, RAD_ENOMEM. */
uint8_t *folder_read_first(const struct folder *f, const uint8_t job[MSG_JOB],
                           size_t *len, struct rad_error *err);
/* The job's pictures are made with these rendering options from now on; those
 * of its specification are not kept.  RAD_ENOMEM. */
int folder_set_options(struct folder *f, const uint8_t job[MSG_JOB],
                       const char *options, struct rad_error *err);
/* Wait until all rows that were put are on the disk. */
int folder_sync(struct folder *f, struct rad_error *err);

/* Write a frame's picture, and its distances; marks, which may be NULL, gets
 * their marks. */
int folder_picture(struct folder *f, const uint8_t job[MSG_JOB], uint32_t frame,
                   struct saved_frame *marks, struct rad_error *err);
/* Remove a frame's rows, once it is noted that its picture is there. */
void folder_drop_rows(struct folder *f, const uint8_t job[MSG_JOB],
                      uint32_t frame);
int folder_stats(struct folder *f, const uint8_t job[MSG_JOB], const char *text,
                 size_t len, struct mark *mark, struct rad_error *err);

/* The file to read for what is asked for; a preview is made first if make. */
int folder_find(struct folder *f, const uint8_t job[MSG_JOB], uint32_t frame,
                enum msg_what what, bool make, char path[DISK_PATH_MAX],
                struct rad_error *err);

/* Call fn for each job that has a folder, until it returns other than 0; going:
 * one that is being forgotten. */
typedef int folder_fn(void *arg, const uint8_t job[MSG_JOB], bool going,
                      struct rad_error *err);
int folder_each(const struct folder *f, folder_fn *fn, void *arg,
                struct rad_error *err);

#endif
