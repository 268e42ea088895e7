/* elementary.h - sines, powers and the like, with the same bits everywhere
 *
 * libm selects its functions by processor, and versions of it round differently
 * in the last place.  Decisions about a picture must not depend on that: where
 * a hemisphere's ray goes, or whether a record is used.  These functions use
 * sums, products, quotients and square roots, which IEEE 754 defines to the
 * last bit, so all machines of a cluster compute the same numbers.
 * Errors in units in the last place, against libm with more bits: exp, log,
 * log10, pow and cbrt 1; sin, cos, atan, atan2 and hypot 2; tan, asin and acos
 * 4.  For arguments that are not finite the results are libm's, and so are
 * sines of more than 2^20 quarter turns; only the latter may differ between
 * machines.
 * Thread: any. */
#ifndef RAD_ARITH_ELEMENTARY_H
#define RAD_ARITH_ELEMENTARY_H

double rad_sin(double x);
double rad_cos(double x);
double rad_tan(double x);

/* Both at once, in hardly more time than one. */
void rad_sin_and_cos(double x, double *sine, double *cosine);

double rad_asin(double x);
double rad_acos(double x);
double rad_atan(double x);
double rad_atan2(double y, double x);

double rad_exp(double x);
double rad_log(double x);
double rad_log10(double x);
double rad_pow(double x, double y);
double rad_cbrt(double x);
double rad_hypot(double x, double y);

#endif
