/* folder_impl.h - what the files of the folder share
 *
 * Private to folder*.c.
 * Thread: one at a time, as folder.h. */
#ifndef DAEMON_FOLDER_IMPL_H
#define DAEMON_FOLDER_IMPL_H

#include "folder/folder.h"

/*  NONE -> ROWS -> PICTURE */
enum frame_file {
    FILE_NONE,   /* room is kept for its rows, if jobs last */
    FILE_ROWS,   /* rows of it came */
    FILE_PICTURE /* its picture is there, and its rows are gone */
};

struct frame_rows {
    enum frame_file file;
    struct rows *rows; /* with FILE_ROWS */
    char *view;
    uint32_t number;
    int width, height; /* of the rows */
};

struct folder_job {
    struct folder_job *next;
    uint8_t id[MSG_JOB];
    char *params, *origin;
    bool depth, points;
    int oversample; /* samples a side of a pixel; 1: rows are the picture's */
    double clamp;   /* of a sample's weight; 0: any */
    enum rows_kind kind;
    uint32_t nframes;
    struct frame_rows *frames;
    uint64_t room;  /* bytes that are kept for frames without a file */
    uint32_t npasses;    /* of the ambient cache that are kept, */
    uint64_t pass_bytes; /* in so many bytes */
    bool new_files; /* since the last folder_sync() */
};

/* DIR/jobs/ID with that suffix, or DIR/jobs/ID/FRAME with that one. */
#define FOLDER_ROOM  "/room"
#define FOLDER_STATS "/stats"
#define FOLDER_CACHE "/cache"
#define FOLDER_KEPT  "/kept"
#define FOLDER_NEW   "/new"
#define FOLDER_GONE  ".gone"
void folder_path(const struct folder *f, const uint8_t *id, const char *suffix,
                 char path[DISK_PATH_MAX]);
void folder_frame_path(const struct folder *f, const uint8_t *id,
                       uint32_t frame, const char *suffix,
                       char path[DISK_PATH_MAX]);
const char *folder_suffix_of(enum msg_what what);

/* No frame has a file, and no room is kept; NULL when memory is out. */
struct folder_job *folder_new_job(const struct folder *f,
                                  const struct msg_spec *spec,
                                  struct rad_error *err);
void folder_free_job(struct folder_job *j);
/* The job of that id, or the end of the list. */
struct folder_job **folder_find_job(struct folder *f, const uint8_t *id);
/* In place of any that has its id. */
void folder_add_job(struct folder *f, struct folder_job *j);

/* A frame whose rows have a file, which is made if need be; RAD_ENOINPUT: its
 * picture is there, or there is no such frame. */
int folder_find_rows(struct folder *f, const uint8_t *id, uint32_t frame,
                     struct folder_job **job, struct frame_rows **rows,
                     struct rad_error *err);
/* Close the file of a frame's rows. */
void folder_free_rows(struct frame_rows *r);

/* Bytes of the rows of a frame. */
uint64_t folder_frame_bytes(const struct folder_job *j,
                            const struct frame_rows *r);

#endif
