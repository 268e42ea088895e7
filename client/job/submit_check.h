/* submit_check.h - whether a whole command line makes sense */
#ifndef RADD_CLIENT_SUBMIT_CHECK_H
#define RADD_CLIENT_SUBMIT_CHECK_H

#include "job/submit_options.h"
#include "base/error.h"

/* Check a whole command line, and settle what depends on several options: the
 * samples of a pixel (from here on -x and -y count samples), how a .png is
 * shown, a file of costs.  Returns 0, or a negative code and a message. */
int submit_check(struct submit_options *o, struct rad_error *err);

#endif
