/* folder.h - the files of jobs: rows as they come, and pictures
 *
 * DIR/jobs/ID/N.rows   pixels of frame N (rows.h), until its picture is there
 * DIR/jobs/ID/N.hdr    the picture, N.z its distances
 * DIR/jobs/ID/stats    statistics of a job that is over, as JSON
 *
 * All calls do I/O and may wait for the disk; what writes may be called again
 * after RAD_EFULL.
 * Thread: one at a time. */
#ifndef DAEMON_FOLDER_H
#define DAEMON_FOLDER_H

#include "blobs.h"
#include "disk.h"
#include "action.h"
#include "saved.h"

struct folder_job;

/* Zeroed but for dir and durable. */
struct folder {
    char dir[BLOBS_DIR_MAX]; /* of all: that in which jobs/ lies */
    bool durable;
    struct folder_job *jobs; /* that are not over */
};

/* Make dir/jobs. */
int folder_init(struct folder *f, struct rad_error *err);
void folder_release(struct folder *f);

/* Make the job's folder and room for its rows; durable: they last. */
int folder_make(struct folder *f, const struct msg_spec *spec,
                struct rad_error *err);
/* Go on with the files that are there: RAD_EDATA for those that are missing, or
 * not as long as they should be.  over: only its pictures are looked for. */
int folder_take_up(struct folder *f, const struct saved_job *s, bool over,
                   struct rad_error *err);
bool folder_is_there(const struct folder *f, const uint8_t job[MSG_JOB]);
/* It is over: rows that are left go. */
void folder_rest(struct folder *f, const uint8_t job[MSG_JOB]);
/* All of it goes: at once, or not at all. */
void folder_forget(struct folder *f, const uint8_t job[MSG_JOB]);
/* Bytes that its files take. */
uint64_t folder_bytes(const struct folder *f, const uint8_t job[MSG_JOB]);

/* pixels is n bytes, of floats or coded; line, which may be NULL, what goes
 * with coded ones: floats of the last row.  Where sum is not NULL it gets their
 * rowsum(), as they are in the file.  RAD_EPROTO when they do not lie in the
 * picture. */
int folder_put_rows(struct folder *f, const struct action_rows *key,
                    const void *pixels, size_t n, const float *line,
                    uint64_t *sum, struct rad_error *err);
/* Row y, as in a BASE_LINE; of coded ones it must have been put as a line. */
int folder_read_row(struct folder *f, const uint8_t job[MSG_JOB],
                    uint32_t frame, uint32_t y, uint8_t *pixels,
                    struct rad_error *err);
/* rowsum() of the first rows of an area, as they are in the file; line: that of
 * the last of them was put, too. */
int folder_sum(struct folder *f, const uint8_t job[MSG_JOB],
               const struct partition_area *a, uint32_t rows, bool line,
               uint64_t *sum, struct rad_error *err);
/* What was written to rows lasts. */
int folder_sync(struct folder *f, struct rad_error *err);

/* Write a frame's picture, and its distances. */
int folder_picture(struct folder *f, const uint8_t job[MSG_JOB], uint32_t frame,
                   struct rad_error *err);
/* It is noted that they are there: its rows go. */
void folder_drop_rows(struct folder *f, const uint8_t job[MSG_JOB],
                      uint32_t frame);
int folder_stats(struct folder *f, const uint8_t job[MSG_JOB], const char *text,
                 size_t len, struct rad_error *err);

/* The file to read for what is asked for; a preview is made first if make. */
int folder_find(struct folder *f, const uint8_t job[MSG_JOB], uint32_t frame,
                enum msg_what what, bool make, char path[DISK_PATH_MAX],
                struct rad_error *err);

/* Call fn for each job that has a folder. */
int folder_each(const struct folder *f,
                int (*fn)(void *arg, const uint8_t job[MSG_JOB],
                          struct rad_error *err),
                void *arg, struct rad_error *err);

#endif
