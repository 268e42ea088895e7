/* passcost.h - about how much of a job's work its passes are
 *
 * For who says how far a job is, before anything else tells.  By the options
 * and the sizes of the pictures alone, fitted to rays of five scenes (office by
 * night and by day, cornell, virtual, mirror) at 400 to 1024 columns, -ab 1 to
 * 5, -aa .15 to .3, -ad 64 to 256: scenes are off by a factor of two, and of
 * three at most, in what tiles trace over what the pictures' pixels trace.
 * Thread: any. */
#ifndef RAD_PASSES_PASSCOST_H
#define RAD_PASSES_PASSCOST_H

#include "passes/passplan.h"

/* The part of all rays that tiles trace, 0 to 1; reuse: the job begins with the
 * records of a former one.  0 without a cache. */
double rad_passcost_part(const struct rad_params *par,
                         const struct rad_pass_size *size, uint32_t nsizes,
                         bool reuse);

/* The work of each of these passes, in one unit. */
void rad_passcost_weigh(const struct rad_pass *pass, uint32_t n,
                        double *weight);

#endif
