/* submit_check.h - options that exclude or need each other */
#ifndef RADD_CLIENT_SUBMIT_CHECK_H
#define RADD_CLIENT_SUBMIT_CHECK_H

#include "job/submit_options.h"
#include "base/error.h"

/* Is a whole command line sound?  Settles what goes by several options: the
 * samples of a pixel (from here on -x and -y count samples), the look of a
 * .png, a file of costs.  Returns 0, or a negative code and a message. */
int submit_check(struct submit_options *o, struct rad_error *err);

#endif
