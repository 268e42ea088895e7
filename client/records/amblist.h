/* amblist.h - the options -aE and -aI: names of modifiers from a file
 *
 * Each word of the file counts as an -ae or -ai option.  The file is looked for
 * along RAYPATH, as in rpict(1). */
#ifndef RADD_CLIENT_AMBLIST_H
#define RADD_CLIENT_AMBLIST_H

#include "base/params.h"

/* Take the option at argv[0] if it is one of these.  Returns as
 * rad_params_option() does; RAD_ENOINPUT: there is no such file. */
int amblist_option(struct rad_params *p, int argc, char *const argv[],
                   struct rad_error *err);

#endif
