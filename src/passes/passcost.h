/* passcost.h - an estimate of how much of a job's work its passes are
 *
 * Used to say how far a job is.  The estimate follows from the options and the
 * sizes of the pictures.  It is fitted to the rays of five scenes (office by
 * night and by day, cornell, virtual, mirror) at 120 to 1024 columns, -ab 1 to
 * 5, -aa .15 to .3, -ad 64 to 512.  Its ratio of tiles' rays to pixels' rays is
 * off by a factor of about two, and three at most.
 * Thread: any. */
#ifndef RAD_PASSES_PASSCOST_H
#define RAD_PASSES_PASSCOST_H

#include "passes/passplan.h"

/* The part of a job's rays that tiles trace, 0 to 1; 0 without a cache.
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
