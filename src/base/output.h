/* output.h - files that are written whole or not at all
 *
 * A file is written under a temporary name in its own folder and then renamed.
 * It takes the mode and, if permitted, owner and group of the file that it
 * replaces.  What is no regular file (a terminal, a pipe, /dev/null), or is a
 * descriptor of this process (/dev/stdout), is written to directly.  For a link
 * its target is made or replaced, not the link.
 * Thread: any, each output its own.  */
#ifndef RAD_BASE_OUTPUT_H
#define RAD_BASE_OUTPUT_H

#include "base/error.h"

#include <stdbool.h>
#include <stdio.h>

struct rad_output {
    FILE *file;
    char *path; /* for messages; NULL: standard output */
    char *real; /* path without links: the name to write or replace */
    char *temp; /* temporary name; NULL: written to directly */
    bool durable; /* sync to the disk before the file gets its name */
};

/* Guard the process before it opens anything.  A closed standard input, output
 * or error is replaced by a descriptor that can only fail, so that no file or
 * socket gets its number.  And writing beyond a limit on file sizes (ulimit -f)
 * becomes an error of the write instead of a signal. */
void rad_output_guard(void);

/* Can path be written?  0, or RAD_ECANTCREAT with the reason.  Called before
 * work begins, since a picture that cannot be kept need not be rendered. */
int rad_output_check(const char *path, struct rad_error *err);

/* Is it written to directly, so that writing may wait for a reader?  Also
 * standard output (NULL). */
bool rad_output_in_place(const char *path);

/* Do two names stand for the same file, so that writing the second would
 * overwrite the first?  False for terminals, pipes and /dev/null. */
bool rad_output_same(const char *a, const char *b);

/* Open for writing; path NULL: standard output.  0, RAD_ECANTCREAT or
 * RAD_ENOMEM. */
int rad_output_open(struct rad_output *out, const char *path, bool durable,
                    struct rad_error *err);

/* Close the file and give it its name.  RAD_EIO: the old file stays. */
int rad_output_commit(struct rad_output *out, struct rad_error *err);

/* Discard what was written.  After a commit nothing happens. */
void rad_output_abort(struct rad_output *out);

/* Write a file of n bytes: open, write, commit. */
int rad_output_write(const char *path, const void *bytes, size_t n,
                     bool durable, struct rad_error *err);

/* Make a folder with this mode, and missing folders above it with mode 0755.
 * It may exist already.  RAD_ECANTCREAT. */
int rad_make_dir(const char *path, int mode, struct rad_error *err);

/* Remove a folder and all in it; links in it are removed, not followed.  What
 * cannot be removed stays. */
void rad_remove_dir(const char *path);

#endif
