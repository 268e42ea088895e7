/* disk.c - see disk.h */
#include "config.h"

#include "light/sample/disk.h"
#include "arith/angle.h"

#include <math.h>

void
rad_disk_of_square(double x, double y, double d[2])
{
    double a = 2 * x - 1, b = 2 * y - 1, sine, cosine;
    int along = !(fabs(a) > fabs(b)); /* index of the larger coordinate */
    double r = along ? b : a, over = along ? a : b;

    if (r == 0) {
        d[0] = d[1] = 0;
        return;
    }
    rad_sin_cos(M_PI / 4 * (over / r), &sine, &cosine);
    d[along] = r * cosine;
    d[!along] = r * sine;
}

void
rad_square_of_disk(double x, double y, double s[2])
{
    double r = sqrt(x * x + y * y);
    int along = fabs(x) > fabs(y) ? 0 : 1;
    double lead = along ? y : x, other = along ? x : y;
    double turn = lead != 0 ? rad_angle(fabs(other), fabs(lead)) : 0;

    if ((other < 0) != (lead < 0))
        turn = -turn;

    r = lead < 0 ? -r : r;
    s[along] = (r + 1) / 2;
    s[!along] = (r * turn * (4 / M_PI) + 1) / 2;
}
