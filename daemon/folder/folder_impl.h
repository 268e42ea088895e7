/* folder_impl.h - what the files of the folder share
 *
 * Private to folder*.c.
 * Thread: one at a time, as folder.h. */
#ifndef DAEMON_FOLDER_IMPL_H
#define DAEMON_FOLDER_IMPL_H

#include "folder/folder.h"

/*  NONE -> ROWS -> PICTURE */
enum frame_file {
    FILE_NONE,   /* room is kept for the frame's rows, if jobs last */
    FILE_ROWS,   /* rows of the frame have a file */
    FILE_PICTURE /* the frame's picture is there, its rows are gone */
};

struct frame_rows {
    enum frame_file file;
    struct rows *rows; /* in FILE_ROWS */
    char *view;
    uint32_t number;
    int width, height; /* of the rows [pixels or samples] */
};

struct folder_job {
    struct folder_job *next;    /* in its chain of folder.jobs */
    struct folder_job *changed; /* next in the list folder.changed, */
    bool new_files;             /* if the job is in that list */
    uint8_t id[MSG_JOB];
    char *params, *origin;
    bool depth, points;
    int oversample; /* samples a side of a pixel; 1: rows are the picture's */
    double clamp;   /* see struct rad_filter_shape; 0: off */
    bool edges;     /* pictures have them (image/edge.h) */
    enum rows_kind kind;
    uint32_t nframes;
    struct frame_rows *frames;
    uint64_t room;  /* bytes that are kept for frames without a file */
    uint32_t npasses;    /* kept passes of the ambient cache, */
    uint64_t pass_bytes; /* and their bytes in the file */
};

/* Set path to DIR/jobs/ID and the suffix; to DIR/jobs/ID/FRAME and the suffix.
 */
#define FOLDER_ROOM  "/room"
#define FOLDER_STATS "/stats"
#define FOLDER_CACHE "/cache"
#define FOLDER_KEPT  "/kept"
#define FOLDER_NEW   "/new"
#define FOLDER_OVER  "/over"
#define FOLDER_GONE  ".gone"
void folder_path(const struct folder *f, const uint8_t *id, const char *suffix,
                 char path[DISK_PATH_MAX]);
void folder_frame_path(const struct folder *f, const uint8_t *id,
                       uint32_t frame, const char *suffix,
                       char path[DISK_PATH_MAX]);
const char *folder_suffix_of(enum msg_what what);

/* Make a job of which no frame has a file, and that keeps no room; NULL: memory
 * is out. */
struct folder_job *folder_new_job(const struct folder *f,
                                  const struct msg_spec *spec,
                                  struct rad_error *err);
void folder_free_job(struct folder_job *j);
/* Find the link to the job of that id, or to NULL at the end of its chain. */
struct folder_job **folder_find_job(struct folder *f, const uint8_t *id);
/* Add a job, in place of a job that has its id. */
void folder_add_job(struct folder *f, struct folder_job *j);

/* Find a frame's rows, and their job where a caller asks for that, and make
 * their file if they have none.  RAD_ENOINPUT, and no rows: the frame's picture
 * is there, or there is no such frame. */
int folder_find_rows(struct folder *f, const uint8_t *id, uint32_t frame,
                     struct folder_job **job, struct frame_rows **rows,
                     struct rad_error *err);
/* Close the file of a frame's rows. */
void folder_free_rows(struct frame_rows *r);

/* Bytes of pixels of a frame's rows. */
uint64_t folder_frame_bytes(const struct folder_job *j,
                            const struct frame_rows *r);

#endif
