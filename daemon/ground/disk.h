/* disk.h - writing so that it lasts
 *
 * What fails for want of room (ENOSPC, EDQUOT, EFBIG) is RAD_EFULL, for want of
 * descriptors or memory (EMFILE, ENFILE, ENOMEM) RAD_ESHORT, which both may be
 * tried again; what is denied RAD_EPERM; all else is RAD_EIO.  A name lasts only
 * when its folder was synced after it.
 * All calls may wait for the disk.
 * Thread: any. */
#ifndef RADD_DAEMON_DISK_H
#define RADD_DAEMON_DISK_H

#include "ground/mark.h"

#include <dirent.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#define DISK_PATH_MAX 1280

/* RAD_EFULL, RAD_ESHORT for what may pass, RAD_EPERM, or RAD_EIO. */
int disk_code(int number);

/* "cannot VERB 'PATH': why", and the code, for an error number. */
int disk_fail(struct rad_error *err, int number, const char *verb,
              const char *path);

/* All n bytes, at that offset; path is for the message. */
int disk_write_at(int fd, const void *data, size_t n, off_t at,
                  const char *path, struct rad_error *err);
/* RAD_EIO also where the file is shorter. */
int disk_read_at(int fd, void *data, size_t n, off_t at, const char *path,
                 struct rad_error *err);

int disk_sync(int fd, const char *path, struct rad_error *err);
int disk_sync_data(int fd, const char *path, struct rad_error *err);
int disk_sync_dir(const char *path, struct rad_error *err);
/* The folder that path lies in. */
int disk_sync_dir_of(const char *path, struct rad_error *err);

/* opendir(), for folders that are looked at beside a loop.  Connections that
 * libuv closes are not seen by ThreadSanitizer, nor is whose number opendir()
 * takes; what is opened by open() is. */
DIR *disk_open_dir(const char *path);

/* A folder that may be there; mode 0700. */
int disk_make_dir(const char *path, struct rad_error *err);

/* A file that gets its name when it is whole. */
struct disk_file {
    char tmp[DISK_PATH_MAX + 8];
    const char *path;
    int fd;
    off_t at; /* what is written */
    size_t n; /* what waits in buf */
    struct mark *mark;
    struct rad_sha sha; /* with mark */
    char buf[1 << 16];
};

/* path is borrowed until the file is closed, and mark, which may be NULL: it
 * gets what was written. */
int disk_file_open(struct disk_file *w, const char *path, struct mark *mark,
                   struct rad_error *err);
/* A rad_sink's; arg is the struct disk_file. */
int disk_file_write(void *arg, const void *data, size_t len,
                    struct rad_error *err);
/* Close and name it, or drop it if rc says that writing failed; durable: the
 * file and its name last when this returns. */
int disk_file_close(struct disk_file *w, int rc, bool durable,
                    struct rad_error *err);

#endif
