/* spot.c - see spot.h */
#include "config.h"

#include "light/sample/spot.h"
#include "arith/elementary.h"
#include "base/vec.h"

bool
rad_spot_init(struct rad_spot *spot, const double reals[7])
{
    if (!(reals[3] > 0))
        return false;
    rad_copy(spot->aim, reals + 4);
    spot->focal_length = rad_normalize(spot->aim);
    /* half the angle, in radians */
    spot->omega = 2 * M_PI * (1 - rad_cos(M_PI / 360 * reals[3]));
    return spot->focal_length > 0;
}

bool
rad_spot_outside(const struct rad_spot *spot, const double dir[3])
{
    return spot->omega < 2 * M_PI * (1 + rad_dot(spot->aim, dir));
}
