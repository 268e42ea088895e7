/* inifile.h - a settings file, line by line
 *
 * INI as inih reads it: "key = value", "[section]", comments after '#' or ';'.
 * Each error names file and line.  A line too long for inih, which would split
 * it, is an error.
 * Thread: any. */
#ifndef RADD_NET_INIFILE_H
#define RADD_NET_INIFILE_H

#include "base/error.h"

#include <stdio.h>

/* Takes one line's key and value; section is "" before the first.  Returns 0,
 * or a negative code with *err set, whose `where` becomes file and line. */
typedef int inifile_fn(void *arg, const char *section, const char *name,
                       const char *value, struct rad_error *err);

/* Read the open file to its end; path is for messages.  Returns 0; the first
 * error of fn; RAD_ECONFIG for a line that is not a setting; RAD_EIO. */
int inifile_read(FILE *file, const char *path, inifile_fn *fn, void *arg,
                 struct rad_error *err);

#endif
