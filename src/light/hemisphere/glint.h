/* glint.h - a place that is far brighter than the rest of a hemisphere
 *
 * An ambient record keeps one such place of its hemisphere (bright.h).  */
#ifndef RAD_LIGHT_GLINT_H
#define RAD_LIGHT_GLINT_H

struct rad_glint {
    float p[3]; /* its point in the scene */
    float lum;  /* luminance of its radiance [W/sr/m^2]; 0: there is none */
};

#endif
