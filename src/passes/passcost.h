/* passcost.h - an estimate of how much of a job's work its passes are
 *
 * Used to say how far a job is.  The estimate follows from the options and the
 * sizes of the pictures.  It is fitted to the processor time of seven scenes
 * (office by night and by day, cornell, virtual, mirror, a gallery with spots,
 * a reading room) at 120 to 2400 columns, -ab 1 to 7, -aa .1 to .4, -ad 64 to
 * 512.  The ratio of tiles' work to pixels' work is off by a factor of about
 * 1.5, and four at most.
 * Thread: any. */
#ifndef RAD_PASSES_PASSCOST_H
#define RAD_PASSES_PASSCOST_H

#include "passes/passplan.h"

/* The part of a job's work that tiles are, 0 to 1; 0 without a cache.
 *   reuse  the job begins with the records of a former job */
double rad_passcost_part(const struct rad_params *par,
                         const struct rad_pass_size *size, uint32_t nsizes,
                         bool reuse);

/* Set weight[i] to the work of each of n passes, as the options and the sizes
 * let foresee, all in the same unit. */
void rad_passcost_weigh(const struct rad_params *par,
                        const struct rad_pass *pass, uint32_t n,
                        double *weight);

#endif
