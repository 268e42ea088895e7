/* glint.h - something far brighter than what else a hemisphere saw
 *
 * An ambient record keeps that of its hemisphere, and travels with it.  */
#ifndef RAD_LIGHT_GLINT_H
#define RAD_LIGHT_GLINT_H

struct rad_glint {
    float p[3]; /* where it is */
    float lum;  /* luminance of its radiance [W/sr/m^2]; 0: there was nothing */
};

#endif
