/* elementary.h - sines, powers and the like, with the same bits everywhere
 *
 * libm chooses its functions by the processor, and other versions of it round
 * differently in the last place.  What decides about a picture must not: where
 * a hemisphere's ray goes, whether a record serves.  These functions are sums,
 * products, quotients and square roots, which IEEE 754 defines to the last bit,
 * so all machines of a cluster come to the same numbers.
 * Errors in units in the last place, against libm with more bits: exp, log,
 * log10, pow and cbrt 1; sin, cos, atan, atan2 and hypot 2; tan, asin and
 * acos 4. What is not finite comes out as libm's; so do sines of more than 2^20
 * quarter turns, the only ones that the machine has a say in. Thread: any. */
#ifndef RAD_ARITH_ELEMENTARY_H
#define RAD_ARITH_ELEMENTARY_H

double rad_sin(double x);
double rad_cos(double x);
double rad_tan(double x);

/* Both at once, for hardly more than one. */
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
