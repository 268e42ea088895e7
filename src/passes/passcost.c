/* passcost.c - see passcost.h
 *
 * Tiles trace a hemisphere, of -ad and -as rays, for each record.  With a finer
 * cache (-aa) tiles make more records, but pixels look up more of them, and
 * make more for themselves: that changes both sides alike.  With more pixels
 * there are only slightly more records.
 *
 * A tile of a lattice ends when it has traced the rays of some hemispheres, so
 * lattices take about as long as they have tiles; those of the coarsest
 * lattices also make the deep records that paths left out.
 *
 * What lattices leave to scattered passes goes from a hundredth of the finest
 * lattice to 30 times that.  It is what scenes differ by: next to nothing in a
 * plain box, four times the mean in a room full of books. */
#include "config.h"

#include "passes/passcost.h"

#include <math.h>

/* Work of tiles over work of pixels, in a picture of SOME_PIXELS, with
 * SOME_RAYS for a hemisphere and two bounces. */
static const double ODDS = 3.8, SOME_PIXELS = 160000, SOME_RAYS = 160;

/* The factor for one bounce, which needs no deep records. */
static const double SINGLE = .42;

/* The factor if the job begins with the records of a former job. */
static const double REUSED = .25;

static const double LEAST_ODDS = 1. / 4, MOST_ODDS = 40;

double
rad_passcost_part(const struct rad_params *par,
                  const struct rad_pass_size *size, uint32_t nsizes, bool reuse)
{
    double pixels = 0, rays = par->ambdiv + par->ambssamp, odds = ODDS;

    if (par->ambounce < 1 || !(par->ambacc > 0) || par->ambdiv < 1)
        return 0;
    for (uint32_t i = 0; i < nsizes; i++)
        pixels += (double)size[i].width * size[i].height;
    odds *= pow(rays / SOME_RAYS, .7) * pow(SOME_PIXELS / pixels, .2);
    odds *= par->ambounce == 1 ? SINGLE : pow(par->ambounce / 2., .15);
    odds *= reuse ? REUSED : 1;
    odds = fmin(fmax(odds, LEAST_ODDS), MOST_ODDS);
    return odds / (1 + odds);
}

/* Work of all passes of the first level of deep records over that of the
 * lattice of every 16th pixel; the factor for each level after it, since its
 * records are fewer and have smaller hemispheres; and for the last level, whose
 * hemispheres meet no surface that needs a record. */
static const double LEVEL = .75, DEEPER = .6, LAST = .4;

/* Work of the pass that walks WALKED paths, in a job with WALK_RAYS for a
 * hemisphere. */
static const double WALK = .15, WALKED = 5000, WALK_RAYS = 120;

static double
walk_weight(const struct rad_params *par, const struct rad_pass *pass)
{
    return WALK * (pass->end - pass->first) / WALKED * WALK_RAYS /
           (par->ambdiv + par->ambssamp);
}

/* The work of a round of paths, or of a part of it, in any unit: it grows less
 * than the number of paths, since later paths find less that is new. */
static double
round_weight(const struct rad_pass *pass)
{
    return pow(pass->end - pass->first, .4) *
           (pass->part < 0 ? 1 : 1. / RAD_PASS_PARTS);
}

/* The work of pass `of`: its share of the work of all passes of its level. */
static double
level_weight(const struct rad_params *par, const struct rad_pass *pass,
             uint32_t n, const struct rad_pass *of)
{
    double level = LEVEL * pow(DEEPER, of->level - 1), all = 0;

    if (of->level == par->ambounce - 1)
        level *= LAST;
    for (uint32_t i = 0; i < n; i++)
        if (pass[i].level == of->level)
            all += round_weight(&pass[i]);
    return level * round_weight(of) / all;
}

/* Work of the lattice with this step over that of every 16th pixel.  Without
 * deep records to make, coarse lattices take less of it. */
static double
step_weight(const struct rad_params *par, int step)
{
    bool deep = par->ambounce > 1;
    double weight = 1;

    for (int i = 16; i < step; i *= 2)
        weight *= deep ? .6 : .3;
    if (step < 16)
        weight *= deep ? 1.1 : 2.4;
    for (int i = step; i < 8; i *= 2)
        weight *= 2.5;
    return weight;
}

/* The work of a lattice.  Frames after the first find half of the records that
 * they need. */
static double
lattice_weight(const struct rad_params *par, const struct rad_pass *pass)
{
    double weight = step_weight(par, pass->step) * (pass->field < 0 ? 1 : .5) *
                    (pass->part < 0 ? 1 : 1. / RAD_PASS_PARTS);
    uint32_t frames = (pass->beyond - 1 - pass->frame) / pass->stride + 1;

    return pass->frame > 0 ? .5 * frames * weight : weight;
}

/* What lattices leave out, in work of the finest lattice: if that has
 * LEFT_POINTS, with -aa LEFT_ACC and two bounces; the factor for one bounce. It
 * is never more than MOST_LEFT, with one bounce than 1. */
static const double LEFT = 2.8, LEFT_POINTS = 3600, LEFT_ACC = .2,
                    LEFT_SINGLE = .06, MOST_LEFT = 80;

/* The share of a scattered pass in the work of all rounds, or of its part of
 * them.  Later squares find slightly less that is new. */
static double
scattered_share(const struct rad_pass *pass)
{
    return pow((double)pass->end / pass->squares, .85) -
           pow((double)pass->first / pass->squares, .85);
}

/* The work of the scattered pass `of`, in work of the finest lattice. */
static double
scattered_weight(const struct rad_params *par, const struct rad_pass *of)
{
    /* its step is twice that of the finest lattice */
    double side = of->side * 2, parts = of->part < 0 ? 1 : RAD_PASS_PARTS;
    double points = parts * of->squares * side * side;
    double left = LEFT * pow(LEFT_ACC / par->ambacc, 3.5) *
                  pow(LEFT_POINTS / points, 1.5);

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
        return walk_weight(par, of);
    if (of->level > 0)
        return level_weight(par, pass, n, of);
    if (!of->scattered)
        return lattice_weight(par, of);
    for (uint32_t i = 0; i < n; i++)
        if (pass[i].finest && !pass[i].scattered &&
            pass[i].frame >= of->frame && pass[i].frame < of->beyond)
            finest += lattice_weight(par, &pass[i]);
    return finest * scattered_weight(par, of);
}

void
rad_passcost_weigh(const struct rad_params *par, const struct rad_pass *pass,
                   uint32_t n, double *weight)
{
    for (uint32_t i = 0; i < n; i++)
        weight[i] = foreseen(par, pass, n, &pass[i]);
}
