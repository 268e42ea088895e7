/* amblist.h - the options -aE and -aI: names of modifiers from a file
 *
 * The words of the file are as many -ae or -ai options.  It is looked for along
 * RAYPATH, as in rpict(1). */
#ifndef RADD_CLIENT_AMBLIST_H
#define RADD_CLIENT_AMBLIST_H

#include "base/params.h"

/* Take the option at argv[0], if it is one of the two: as
 * rad_params_option(), and RAD_ENOINPUT for a file that is not there. */
int amblist_option(struct rad_params *p, int argc, char *const argv[],
                   struct rad_error *err);

#endif
