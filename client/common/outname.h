/* outname.h - what the name of an output says: its format, and its frame
 *
 * Thread: any.  */
#ifndef RADD_CLIENT_OUTNAME_H
#define RADD_CLIENT_OUTNAME_H

#include "base/error.h"

#include <stdbool.h>

/* Does the name end so (".png")?  Letters' case does not matter. */
bool outname_suffix(const char *path, const char *suffix);

/* The name of a frame's file: pattern with its one "%d" or "%03d" replaced and
 * "%%" made '%'.  To be freed.  RAD_EUSAGE for another conversion, or for none
 * when need is set; RAD_ENOMEM. */
int outname_frame(char **name, const char *pattern, int frame, bool need,
                  struct rad_error *err);

/* The same with a view's name for its one "%s". */
int outname_view(char **name, const char *pattern, const char *view, bool need,
                 struct rad_error *err);

#endif
