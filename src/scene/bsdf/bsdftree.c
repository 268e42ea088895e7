/* bsdftree.c - looking up directions in a tensor tree, and sampling
 *
 * To sample, the running sums of an incident cell are searched for a block
 * (bsdftree.h).  The few leaves of the slice in that block are then visited
 * along Hilbert's curve, so that near random numbers give near directions. */
#include "config.h"

#include "scene/bsdf/bsdftree.h"

#include <math.h>
#include <string.h>

#include "arith/elementary.h"

#define TINY 1e-6 /* keeps the normal in the lower half of isotropic trees */

/* --- going down --- */

/* look_up() for a rank that the compiler knows. */
static inline __attribute__((always_inline)) double
look_up_rank(const struct bsdf_node *n, int rank, const double place[4],
             double corner[4], int *level)
{
    int left = RAD_MAX_BSDF_LEVELS;
    uint32_t way[4];
    size_t at = 0;

    for (int i = 0; i < rank; i++)
        way[i] = (uint32_t)(place[i] * (1 << RAD_MAX_BSDF_LEVELS));
    while (n->lg < 0) {
        unsigned bits = 0;

        left--;
        for (int i = 0; i < rank; i++)
            bits |= (way[i] >> left & 1) << i;
        n = n->u.kid[bits];
    }
    left -= n->lg;
    for (int i = 0; i < rank; i++)
        at = at << n->lg | (way[i] >> left & ((1u << n->lg) - 1));
    if (level)
        *level = RAD_MAX_BSDF_LEVELS - left;
    if (corner) {
        double size = 1. / (1 << (RAD_MAX_BSDF_LEVELS - left));

        for (int i = 0; i < rank; i++)
            corner[i] = (way[i] >> left) * size;
    }
    return (double)n->u.value[at];
}

/* The value at a place.  corner and level, which may be NULL, get its cell: the
 * lowest corner, and log2 of 1 / its width.  The bits of the coordinates choose
 * the way down. */
static double
look_up(const struct bsdf_node *n, int rank, const double place[4],
        double corner[4], int *level)
{
    return rank == 3 ? look_up_rank(n, 3, place, corner, level)
                     : look_up_rank(n, 4, place, corner, level);
}

/* --- colours --- */

static void
to_xyz(double y, double u, double v, double xyz[3])
{
    double f = 6 * u - 16 * v + 12;
    double cx = 9 * u / f, cy = 4 * v / f;

    if (!(cy > 0 && f > 0)) { /* no colour */
        xyz[0] = xyz[1] = xyz[2] = y;
        return;
    }
    xyz[0] = cx / cy * y;
    xyz[1] = y;
    xyz[2] = (1 - cx - cy) / cy * y;
}

void
rad_tree_channels(const struct bsdf_tree *t, double y, const double place[4],
                  double c[3])
{
    double xyz[3];

    to_xyz(y, look_up(t->root[U], t->rank, place, NULL, NULL),
           look_up(t->root[V], t->rank, place, NULL, NULL), xyz);
    rad_bsdf_sharpen(c, xyz);
}

/* --- looking up --- */

static double
inside(double x)
{
    return x > 0 ? x < 1 ? x : 1 - 0x1p-53 : 0;
}

/* The arc tangent of t in [-1, 1], times 4 / pi, to 1e-13: the argument is
 * reduced twice by atan(t) = 2 atan(t / (1 + sqrt(1 + t^2))), then the
 * series. */
static double
eighths(double t)
{
    double x = t / (1 + sqrt(1 + t * t)), x2;

    x /= 1 + sqrt(1 + x * x);
    x2 = x * x;
    return 16 / M_PI * x *
           (1 -
            x2 * (1. / 3 -
                  x2 * (1. / 5 -
                        x2 * (1. / 7 -
                              x2 * (1. / 9 -
                                    x2 * (1. / 11 -
                                          x2 * (1. / 13 -
                                                x2 * (1. / 15 -
                                                      x2 * (1. / 17)))))))));
}

/* Shirley and Chiu's map from the disk to the unit square.  The larger
 * coordinate becomes the radius, the other one a share of the radius by
 * angle. */
static void
to_square(double x, double y, double sq[2])
{
    double r = sqrt(x * x + y * y), a, b;

    if (fabs(x) > fabs(y)) {
        a = copysign(r, x);
        b = r * eighths(y / fabs(x));
    } else {
        a = y != 0 ? r * eighths(x / fabs(y)) : 0;
        b = copysign(r, y);
    }
    sq[0] = inside(a / 2 + .5);
    sq[1] = inside(b / 2 + .5);
}

static void
to_disk(const double sq[2], double *x, double *y)
{
    double a = 2 * sq[0] - 1, b = 2 * sq[1] - 1, r, phi;

    if (a > -b) {
        r = a > b ? a : b;
        phi = a > b ? b / a : 2 - a / b;
    } else {
        r = a < b ? -a : -b;
        phi = a < b ? 4 + b / a : b != 0 ? 6 - a / b : 0;
    }
    *x = r * rad_cos(phi * (M_PI / 4));
    *y = r * rad_sin(phi * (M_PI / 4));
}

/* The first coordinate of an isotropic tree, for light from v. */
static double
from_rim(const double v[3])
{
    return inside(.5 - TINY - .5 * sqrt(v[0] * v[0] + v[1] * v[1]));
}

/* When the rest is subtracted, each channel keeps at least this part of the
 * luminance, so that all colours have three channels, as in Radiance. */
#define LEAST_CHANNEL 1e-5

/* A factor near 1 that is different for each cell, as in Radiance: two equal
 * values are of the same cell. */
static double
mark(int rank, const double corner[4])
{
    double d = 0;

    for (int i = 0; i < rank; i++) {
        double x = (2 << i) / (corner[i] + .01687);

        d += x - (int)x - .5;
    }
    return 1 + 1e-4 * d;
}

static bool
is_front(const struct rad_bsdf_way *w)
{
    return w->part->side == SIDE_RF || w->part->side == SIDE_TF;
}

static bool
is_through(const struct rad_bsdf_way *w)
{
    return w->part->side == SIDE_TF || w->part->side == SIDE_TB;
}

/* Set the turn that brings light from v to the azimuth of isotropic trees. */
static void
set_turn(const double v[3], double turn[2])
{
    double r = sqrt(v[0] * v[0] + v[1] * v[1]);

    turn[0] = r > 0 ? -v[0] / r : -1;
    turn[1] = r > 0 ? -v[1] / r : 0;
}

void
rad_tree_look_from(struct rad_bsdf_way *w, const double v[3])
{
    w->swapped = is_through(w) && (v[2] > 0) != is_front(w);
    if (w->part->tree->rank == 4) {
        double sign = w->swapped ? 1 : -1;

        to_square(sign * v[0], sign * v[1], w->sq);
    } else {
        w->sq[0] = 0;
        w->sq[1] = from_rim(v);
        set_turn(v, w->turn);
    }
}

/* The place of incident and outgoing light in an isotropic tree. */
static void
turned_place(const struct rad_bsdf_way *w, const double *in, const double *out,
             double place[4])
{
    double swapped[2];
    const double *turn = w->turn;

    place[0] = w->sq[1];
    if (w->swapped) {
        const double *eye = in;

        in = out;
        out = eye;
        place[0] = from_rim(in);
        set_turn(in, swapped);
        turn = swapped;
    }
    to_square(turn[0] * out[0] + turn[1] * out[1],
              turn[0] * out[1] - turn[1] * out[0], place + 1);
}

void
rad_tree_value(const struct rad_bsdf_way *w, const double in[3],
               const double out[3], double xyz[3], double *cell)
{
    const struct bsdf_tree *t = w->part->tree;
    double place[4] = { 0 }, corner[4], y, f, c[3];
    int level;

    if (t->rank == 3) {
        turned_place(w, in, out, place);
    } else if (w->swapped) {
        to_square(-out[0], -out[1], place);
        memcpy(place + 2, w->sq, sizeof w->sq);
    } else {
        memcpy(place, w->sq, sizeof w->sq);
        to_square(out[0], out[1], place + 2);
    }
    y = look_up(t->root[Y], t->rank, place, corner, &level);
    *cell = M_PI / (double)((int64_t)1 << 2 * level);
    if (!t->root[U]) {
        if (!(rad_tree_above_rest(t, y) > 0))
            return;
        f = mark(t->rank, corner);
        xyz[0] = xyz[1] = xyz[2] = f * rad_tree_above_rest(t, y);
        return;
    }
    f = mark(t->rank, corner);
    rad_tree_channels(t, y, place, c);
    for (int i = 0; i < 3; i++)
        c[i] = f * (t->rest_y > 0 ? fmax(c[i] - t->rest[i], LEAST_CHANNEL * y)
                                  : c[i]);
    rad_bsdf_unsharpen(xyz, c);
}

/* The incident cell of the light, and the place of the cell's middle.  NULL:
 * there is none. */
static const struct bsdf_cell *
find_slice(const struct rad_bsdf_way *w, double middle[2])
{
    const struct bsdf_tree *t = w->part->tree;
    const struct bsdf_slices *s = w->swapped ? &t->reverse : &t->slices;
    double res = (double)(1 << s->res_log);
    size_t row = (size_t)(w->sq[0] * res), column = (size_t)(w->sq[1] * res);

    if (!s->cell)
        return NULL;
    middle[0] = ((double)row + .5) / res;
    middle[1] = ((double)column + .5) / res;
    return &s->cell[(row << s->res_log) + column];
}

void
rad_tree_cells(const struct rad_bsdf_way *w, double range[2])
{
    double middle[2];
    const struct bsdf_cell *c = find_slice(w, middle);

    if (!c)
        return;
    range[0] = fmin(range[0], M_PI * ldexp(1, -2 * c->finest));
    range[1] = fmax(range[1], M_PI * ldexp(1, -2 * c->coarsest));
}

double
rad_tree_total(const struct rad_bsdf_way *w)
{
    double middle[2];
    const struct bsdf_cell *c = find_slice(w, middle);

    return c ? M_PI * c->total : 0;
}

/* --- sampling --- */

/* A walk along the curve through a slice, to the point of the sample. */
struct walk {
    const struct bsdf_tree *t;
    const struct bsdf_slices *s;
    double left;   /* light still to pass */
    double out[2]; /* the point */
};

/* A cell of the walk. */
struct step {
    struct bsdf_cursor c;
    struct hilbert h;
    double in[2], low[2], size; /* low, size: corner and width in out's
                                 * square */
};

/* take_step() for a rank and a way that the compiler knows. */
static inline __attribute__((always_inline)) void
take_step_of(const struct step *from, unsigned q, int rank, bool reverse,
             struct step *to)
{
    unsigned bits = 0, xy[2], nin = (unsigned)rank - 2;

    to->h = from->h;
    rad_hilbert_enter(&to->h, q, &xy[0], &xy[1]);
    to->size = from->size / 2;
    for (unsigned i = 0; i < 2; i++) {
        bool upper = from->in[i] >= .5;

        to->low[i] = from->low[i] + xy[i] * to->size;
        to->in[i] = 2 * from->in[i] - upper;
        if (reverse)
            bits |= (unsigned)upper << (2 + i) | (xy[i] ^ 1) << i;
        else
            bits |= xy[i] << (nin + i);
        if (!reverse && (nin == 2 || i == 1))
            bits |= (unsigned)upper << (nin == 2 ? i : 0);
    }
    if (rad_tree_at_leaf(&from->c))
        to->c = from->c;
    else
        rad_tree_descend(&from->c, rank, bits, &to->c);
}

/* Go into quarter q of the outgoing square. */
static void
take_step(const struct walk *w, const struct step *from, unsigned q,
          struct step *to)
{
    if (w->t->rank == 3)
        take_step_of(from, q, 3, false, to);
    else
        take_step_of(from, q, 4, w->s->reverse, to);
}

/* Walk through a cell.  True: the point is in it. */
static bool
walk_through(struct walk *w, const struct step *at)
{
    double light, p[2];

    if (!rad_tree_at_leaf(&at->c)) {
        for (unsigned q = 0; q < 4; q++) {
            struct step to;

            take_step(w, at, q, &to);
            if (walk_through(w, &to))
                return true;
        }
        return false;
    }
    light = rad_tree_above_rest(w->t, rad_tree_leaf_value(&at->c, w->t->rank)) *
            at->size * at->size;
    /* always set, in case rounding makes the walk pass the last leaf */
    if (light > 0) {
        rad_hilbert_point(at->h, fmin(w->left / light, 1), p);
        for (int i = 0; i < 2; i++)
            w->out[i] = at->low[i] + p[i] * at->size;
    }
    if (w->left < light)
        return true;
    w->left -= light;
    return false;
}

/* The block, of n, of the point after a fraction x of a slice's light. */
static unsigned
find_block(const struct bsdf_cell *c, unsigned n, double x)
{
    unsigned a = 0, b = n;

    while (b - a > 1) {
        unsigned mid = (a + b) / 2;

        if (x * 0x1p32 >= c->before[mid])
            a = mid;
        else
            b = mid;
    }
    return a;
}

bool
rad_tree_sample(const struct rad_bsdf_way *w, const double in[3], double x,
                double out[3])
{
    const struct bsdf_tree *t = w->part->tree;
    const struct bsdf_slices *s = w->swapped ? &t->reverse : &t->slices;
    struct step at[MOST_BLOCK_LOG + 1];
    const struct bsdf_cell *c = find_slice(w, at->in);
    struct walk walk = { .t = t, .s = s, .out = { -1, -1 } };
    double px, py;
    unsigned block;

    if (!c || !(c->total > 0))
        return false;
    block = find_block(c, 1u << 2 * s->block_log, x);
    walk.left = fmax(x - c->before[block] * 0x1p-32, 0) * c->total;
    at->c = rad_tree_start(t->root[Y]);
    at->h = HILBERT_START;
    at->low[0] = at->low[1] = 0;
    at->size = 1;
    for (int k = 0; k < s->block_log; k++)
        take_step(&walk, &at[k], block >> 2 * (s->block_log - 1 - k) & 3,
                  &at[k + 1]);
    walk_through(&walk, &at[s->block_log]);
    if (walk.out[0] < 0)
        return false;
    to_disk(walk.out, &px, &py);
    out[0] = px;
    out[1] = py;
    if (t->rank == 3) {
        out[0] = w->turn[0] * px - w->turn[1] * py;
        out[1] = w->turn[1] * px + w->turn[0] * py;
    }
    out[2] = sqrt(fmax(1 - px * px - py * py, 0));
    if ((in[2] > 0) == is_through(w))
        out[2] = -out[2];
    return true;
}
