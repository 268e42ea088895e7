/* inifile.h - a settings file, line by line
 *
 * INI as inih reads it: "key = value", "[section]", comments after '#' or ';'.
 * Every error names file and line; a line that inih would split is one, too.
 * Thread: any. */
#ifndef RADD_PROTO_INIFILE_H
#define RADD_PROTO_INIFILE_H

#include "base/error.h"

#include <stdio.h>

/* One line's key and value; section is "" before the first.  Returns 0 or a
 * negative code with *err set, whose `where` becomes file and line. */
typedef int inifile_fn(void *arg, const char *section, const char *name,
                       const char *value, struct rad_error *err);

/* Read the open file to its end; `path` is for messages.  The first failure of
 * fn, RAD_ECONFIG for a line that is no setting, RAD_EIO. */
int inifile_read(FILE *file, const char *path, inifile_fn *fn, void *arg,
                 struct rad_error *err);

#endif
