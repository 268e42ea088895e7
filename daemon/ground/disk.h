/* disk.h - files that last
 *
 * Errors: RAD_EFULL without room (ENOSPC, EDQUOT, EFBIG), RAD_ESHORT without
 * descriptors or memory (EMFILE, ENFILE, ENOMEM): both may be tried again.
 * RAD_EPERM where access is denied; RAD_EIO for all else.
 * A file's new name lasts only when its folder was synced after it was given.
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

/* The code for an error number: RAD_EFULL, RAD_ESHORT, RAD_EPERM or RAD_EIO. */
int disk_code(int number);

/* Set *err to "cannot VERB 'PATH': why" and the code for an error number, which
 * is returned. */
int disk_fail(struct rad_error *err, int number, const char *verb,
              const char *path);

/* Write all n bytes at offset `at`; `path` is named in the error. */
int disk_write_at(int fd, const void *data, size_t n, off_t at,
                  const char *path, struct rad_error *err);
/* Read n bytes from offset `at`.  RAD_EIO also if the file is shorter. */
int disk_read_at(int fd, void *data, size_t n, off_t at, const char *path,
                 struct rad_error *err);

/* Give the first n bytes of a file their room on the disk.  Begun again if a
 * signal interrupts it, as on a tmpfs any may. */
int disk_allocate(int fd, off_t n, const char *path, struct rad_error *err);

/* Sync an open file, or its bytes alone; the file or folder at path.  RAD_EIO
 * if that fails. */
int disk_sync(int fd, const char *path, struct rad_error *err);
int disk_sync_data(int fd, const char *path, struct rad_error *err);
int disk_sync_path(const char *path, struct rad_error *err);
/* Sync the folder that has the file `path`. */
int disk_sync_dir_of(const char *path, struct rad_error *err);

/* opendir() by open() and fdopendir().  ThreadSanitizer does not see libuv
 * close a descriptor, nor opendir() get the same number again, and would report
 * a race; it sees open().  NULL: errno says why. */
DIR *disk_open_dir(const char *path);

/* Make a folder with mode 0700, unless it is there. */
int disk_make_dir(const char *path, struct rad_error *err);

/* A file that gets its name when it is whole. */
struct disk_file {
    char tmp[DISK_PATH_MAX + 8];
    const char *path;
    int fd;
    off_t at; /* bytes in the file */
    size_t n; /* bytes that wait in buf */
    struct mark *mark;
    struct rad_sha sha; /* with mark */
    char buf[1 << 16];
};

/* Begin the file `path`.  mark, unless NULL, gets the mark of all bytes that
 * are written.  path and mark are borrowed until disk_file_close(). */
int disk_file_open(struct disk_file *w, const char *path, struct mark *mark,
                   struct rad_error *err);
/* The function of a rad_sink; arg is the struct disk_file. */
int disk_file_write(void *arg, const void *data, size_t len,
                    struct rad_error *err);
/* Close the file and give it its name, or remove it if rc < 0, the error with
 * which writing failed.  Nothing is synced (syncs.h).  Returns rc, or the first
 * error here. */
int disk_file_close(struct disk_file *w, int rc, struct rad_error *err);

#endif
