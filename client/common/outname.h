/* outname.h - names of outputs: their suffix, and the number of a frame in them
 *
 * Thread: any. */
#ifndef RADD_CLIENT_OUTNAME_H
#define RADD_CLIENT_OUTNAME_H

#include "base/error.h"

#include <stdbool.h>

/* Does the name end so (".png")?  Case does not matter. */
bool outname_suffix(const char *path, const char *suffix);

/* The name of a frame's file: pattern with its one "%d" or "%03d" replaced, and
 * "%%" by '%'.  To be freed.  RAD_EUSAGE: another conversion, or none although
 * `need` is set; RAD_ENOMEM. */
int outname_frame(char **name, const char *pattern, int frame, bool need,
                  struct rad_error *err);

/* The same with a view's name in place of the one "%s". */
int outname_view(char **name, const char *pattern, const char *view, bool need,
                 struct rad_error *err);

#endif
