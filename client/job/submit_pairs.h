/* submit_pairs.h - the table of options that exclude or need each other
 *
 * Only whether options are given counts here; submit_check.h checks values. */
#ifndef RADD_CLIENT_SUBMIT_PAIRS_H
#define RADD_CLIENT_SUBMIT_PAIRS_H

#include "job/submit_options.h"
#include "base/error.h"

/* RAD_EUSAGE, and a message that names two options and says why, for the first
 * rule of the table that a command line breaks.  spectra: the scene is known,
 * and has spectra, so each plane of -cs is a job. */
int submit_pairs_check(const struct submit_options *o, bool spectra,
                       struct rad_error *err);

#endif
