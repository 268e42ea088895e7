/* folder_impl.h - what the files of the folder share
 *
 * Private to folder*.c. */
#ifndef DAEMON_FOLDER_IMPL_H
#define DAEMON_FOLDER_IMPL_H

#include "folder/folder.h"

/*  empty -> begun: its rows have a file -> written: its picture is there */
enum frame_state { FRAME_EMPTY, FRAME_BEGUN, FRAME_WRITTEN };

struct frame_rows {
    enum frame_state state;
    struct rows *rows; /* of one that is begun */
    char *view;
    uint32_t number;
    int width, height; /* of the rows */
};

struct folder_job {
    struct folder_job *next;
    uint8_t id[MSG_JOB];
    char *params, *origin;
    bool depth;
    int oversample; /* samples a side of a pixel; 1: rows are the picture's */
    double clamp;   /* of a sample's weight; 0: any */
    enum rows_kind kind;
    uint32_t nframes;
    struct frame_rows *frames;
    uint64_t room;  /* bytes that are kept for frames that are empty */
    bool new_files; /* since the last folder_sync() */
};

/* DIR/jobs/ID, or DIR/jobs/ID/FRAMEsuffix, .../stats, .../room. */
void folder_job_path(const struct folder *f, const uint8_t *id,
                     char path[DISK_PATH_MAX]);
void folder_frame_path(const struct folder *f, const uint8_t *id,
                       uint32_t frame, const char *suffix,
                       char path[DISK_PATH_MAX]);
void folder_stats_path(const struct folder *f, const uint8_t *id,
                       char path[DISK_PATH_MAX]);
void folder_room_path(const struct folder *f, const uint8_t *id,
                      char path[DISK_PATH_MAX]);
const char *folder_suffix_of(enum msg_what what);

/* All frames are empty, and no room is kept; NULL when memory is out. */
struct folder_job *folder_new_job(const struct folder *f,
                                  const struct msg_spec *spec,
                                  struct rad_error *err);
void folder_free_job(struct folder_job *j);
/* In place of any that has its id. */
void folder_add_job(struct folder *f, struct folder_job *j);

/* Bytes of the rows of a frame. */
uint64_t folder_frame_bytes(const struct folder_job *j,
                            const struct frame_rows *r);

#endif
