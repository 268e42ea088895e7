/* bands.c - see bands.h */
#include "config.h"

#include "base/bands.h"

/* Where red and blue are purest [nm].  A range with both of them shows
 * colours. */
#define RED_PEAK  607.
#define BLUE_PEAK 469.

struct rad_bands
rad_bands_rgb(void)
{
    struct rad_bands b = { 3, RAD_LONGEST_WAVE, RAD_SHORTEST_WAVE, -1 };

    return b;
}

int
rad_bands_planes(const struct rad_bands *b)
{
    return b->plane == RAD_PLANE_COLOURS ? 1 : (b->n + 2) / 3;
}

int
rad_bands_of(const struct rad_bands *b, int plane, int channel)
{
    int planes = rad_bands_planes(b);
    int band = (plane < 0 ? 0 : plane) + channel * planes;

    return band < b->n ? band : band - planes;
}

static void
spread_colours(const struct rad_bands *b, struct rad_rgb c,
               float band[RAD_MAX_BANDS])
{
    const float rgb[] = { c.r, c.g, c.b };

    for (int i = 0; i < b->n; i++)
        band[i] = rgb[rad_bands_primary(b, i)];
}

void
rad_bands_gather(const struct rad_bands *b, const struct rad_rgb plane[],
                 float band[RAD_MAX_BANDS])
{
    if (b->plane == RAD_PLANE_COLOURS) {
        spread_colours(b, plane[0], band);
        return;
    }
    for (int p = 0; p < rad_bands_planes(b); p++) {
        band[rad_bands_of(b, p, 0)] = plane[p].r;
        band[rad_bands_of(b, p, 1)] = plane[p].g;
        band[rad_bands_of(b, p, 2)] = plane[p].b; /* if repeated, the same */
    }
}

bool
rad_bands_show_colour(const struct rad_bands *b)
{
    return b->shortest < BLUE_PEAK && b->longest > RED_PEAK;
}

double
rad_bands_split(const struct rad_bands *b, int i)
{
    static const double tuned[] = { 0, 588, 480 };

    if (i == 0)
        return b->longest;
    if (i == 3)
        return b->shortest;
    if (rad_bands_show_colour(b))
        return tuned[i];
    return b->longest + i / 3. * (b->shortest - b->longest);
}

int
rad_bands_primary(const struct rad_bands *b, int band)
{
    double middle =
        b->longest + (band + .5) * (b->shortest - b->longest) / b->n;

    if (rad_bands_are_rgb(b))
        return band;
    return middle >= rad_bands_split(b, 1)   ? 0
           : middle >= rad_bands_split(b, 2) ? 1
                                             : 2;
}
