/* passcost.c - see passcost.h
 *
 * Tiles trace a hemisphere, of -ad and -as rays, for each record.  There are
 * more records with a smaller -aa, and slightly more with more pixels: the
 * exponents are those of the fit.
 * From the lattice of every 16th pixel on, each lattice takes 1.5 times as long
 * as the next coarser lattice; the finest lattice, which also asks where
 * objects end, takes 1.4 times that.  All paths to records of one level
 * together take .7 of the lattice of every 16th pixel.  What lattices leave to
 * scattered passes goes from a hundredth of the finest lattice to 30 times
 * that, and differs by five between scenes. */
#include "config.h"

#include "passes/passcost.h"

#include <math.h>

/* Rays of tiles over rays of pixels, in a picture of SOME_PIXELS, with
 * SOME_RAYS for a hemisphere, -aa SOME_ACC and two bounces. */
static const double ODDS = 4, SOME_PIXELS = 160000, SOME_RAYS = 160,
                    SOME_ACC = .3;

/* The factor for one bounce, which needs no deep records; and for each bounce
 * after two, which adds few. */
static const double SINGLE = .6, FURTHER = 1.09;

/* The factor if the job begins with the records of a former job. */
static const double REUSED = .25;

static const double LEAST_ODDS = 1. / 4, MOST_ODDS = 12;

double
rad_passcost_part(const struct rad_params *par,
                  const struct rad_pass_size *size, uint32_t nsizes, bool reuse)
{
    double pixels = 0, rays = par->ambdiv + par->ambssamp, odds = ODDS;

    if (par->ambounce < 1 || !(par->ambacc > 0) || par->ambdiv < 1)
        return 0;
    for (uint32_t i = 0; i < nsizes; i++)
        pixels += (double)size[i].width * size[i].height;
    odds *= pow(rays / SOME_RAYS, .6) * pow(SOME_ACC / par->ambacc, 1.7) *
            pow(SOME_PIXELS / pixels, .44);
    odds *= par->ambounce == 1 ? SINGLE : pow(FURTHER, par->ambounce - 2);
    odds *= reuse ? REUSED : 1;
    odds = fmin(fmax(odds, LEAST_ODDS), MOST_ODDS);
    return odds / (1 + odds);
}

/* Work of all passes of a level of deep records, and of the pass that walks,
 * over that of the lattice of every 16th pixel. */
static const double LEVEL = .7, WALK = .05;

/* The work of a round of paths, or of a part of it, in any unit: it grows less
 * than the number of paths, since later paths find less that is new. */
static double
round_weight(const struct rad_pass *pass)
{
    return pow(pass->end - pass->first, .4) *
           (pass->part < 0 ? 1 : 1. / RAD_PASS_PARTS);
}

/* The work of pass `of`: its share of LEVEL among all passes of its level. */
static double
level_weight(const struct rad_pass *pass, uint32_t n, const struct rad_pass *of)
{
    double all = 0;

    for (uint32_t i = 0; i < n; i++)
        if (pass[i].level == of->level)
            all += round_weight(&pass[i]);
    return LEVEL * round_weight(of) / all;
}

/* The factor for the finest lattice. */
static const double FINEST = 1.4;

/* The work of a lattice.  Frames after the first find half of the records that
 * they need. */
static double
lattice_weight(const struct rad_pass *pass)
{
    double weight = (pass->finest ? FINEST : 1) * (pass->field < 0 ? 1 : .5) *
                    (pass->part < 0 ? 1 : 1. / RAD_PASS_PARTS);
    uint32_t frames = (pass->beyond - 1 - pass->frame) / pass->stride + 1;

    for (int step = pass->step; step < 16; step *= 2)
        weight *= 1.5;
    return pass->frame > 0 ? .5 * frames * weight : weight;
}

/* What lattices leave out, in work of the finest lattice: in a picture of
 * LEFT_SIDE squared pixels, with -aa LEFT_ACC and two bounces; the factor for
 * one bounce.  It is never more than MOST_LEFT, with one bounce than 1. */
static const double LEFT = 2, LEFT_SIDE = 240, LEFT_ACC = .2, LEFT_SINGLE = .35,
                    MOST_LEFT = 80;

/* The share of a scattered pass in the work of all rounds, or of its part of
 * them.  Later squares find less that is new: so many squares take as the root
 * of their number. */
static double
scattered_share(const struct rad_pass *pass)
{
    return sqrt((double)pass->end / pass->squares) -
           sqrt((double)pass->first / pass->squares);
}

/* The work of the scattered pass `of`, in work of the finest lattice. */
static double
scattered_weight(const struct rad_params *par, const struct rad_pass *of)
{
    double side = of->side * of->step,
           parts = of->part < 0 ? 1 : RAD_PASS_PARTS;
    double pixels = parts * of->squares * side * side;
    double left = LEFT * pow(LEFT_ACC / par->ambacc, 3.5) *
                  pow(LEFT_SIDE * LEFT_SIDE / pixels, 1.5);

    double most = par->ambounce == 1 ? 1 : MOST_LEFT;

    left *= par->ambounce == 1 ? LEFT_SINGLE : 1;
    left = 1 / (1 / left + 1 / most);
    return left * scattered_share(of) / parts;
}

/* The work of pass `of`, by the options and the sizes alone. */
static double
foreseen(const struct rad_params *par, const struct rad_pass *pass, uint32_t n,
         const struct rad_pass *of)
{
    double finest = 0;

    if (of->tiles == 0)
        return 0;
    if (of->check)
        return 1;
    if (of->walks)
        return WALK;
    if (of->level > 0)
        return level_weight(pass, n, of);
    if (!of->scattered)
        return lattice_weight(of);
    for (uint32_t i = 0; i < n; i++)
        if (pass[i].finest && !pass[i].scattered &&
            pass[i].frame >= of->frame && pass[i].frame < of->beyond)
            finest += lattice_weight(&pass[i]);
    return finest * scattered_weight(par, of);
}

void
rad_passcost_weigh(const struct rad_params *par, const struct rad_pass *pass,
                   uint32_t n, double *weight)
{
    for (uint32_t i = 0; i < n; i++)
        weight[i] = foreseen(par, pass, n, &pass[i]);
}
