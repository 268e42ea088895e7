/* output.h - files that are there whole or not at all
 *
 * A file is written under a temporary name in its own folder and renamed over
 * its name when complete.  What is no regular file (a terminal, a pipe,
 * /dev/null) is written as it is; a link's target is replaced, not the link.
 * Thread: any, each output its own.  */
#ifndef RADD_CLIENT_OUTPUT_H
#define RADD_CLIENT_OUTPUT_H

#include "base/error.h"

#include <stdbool.h>
#include <stdio.h>

struct output {
    FILE *file;
    char *path; /* for messages; NULL: standard output */
    char *real; /* what is replaced; NULL where nothing is */
    char *temp;
    bool durable; /* on the disk before it gets its name */
};

/* Can path be written?  RAD_ECANTCREAT with the reason.  To be asked before
 * work begins: a picture that nobody can keep need not be rendered. */
int output_check(const char *path, struct rad_error *err);

/* Do two names stand for one file, of which the second writer would take away
 * what the first wrote?  A terminal, a pipe or /dev/null does not count. */
bool output_same(const char *a, const char *b);

/* Open for writing; path NULL: standard output.  RAD_ECANTCREAT. */
int output_open(struct output *out, const char *path, bool durable,
                struct rad_error *err);

/* Give the file its name.  RAD_EIO, and the old file stays. */
int output_commit(struct output *out, struct rad_error *err);

/* Take back what was written; does nothing after a commit. */
void output_abort(struct output *out);

/* All three: the n bytes become the file. */
int output_write(const char *path, const void *bytes, size_t n, bool durable,
                 struct rad_error *err);

/* Does the name end so (".png")?  Letters' case does not matter. */
bool output_suffix(const char *path, const char *suffix);

/* The name of a frame's file: pattern with its one "%d" or "%03d" replaced and
 * "%%" made '%'.  To be freed.  RAD_EUSAGE for another conversion, or for none
 * when need is set; RAD_ENOMEM. */
int output_frame_name(char **name, const char *pattern, int frame, bool need,
                      struct rad_error *err);

#endif
