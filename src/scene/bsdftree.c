/* bsdftree.c - scattering as a tensor tree
 *
 * The unit square stands for a hemisphere, mapped so that areas are projected
 * solid angles over pi.  A tree of rank 4 has two coordinates for light that
 * comes in (where it goes on to) and two for light that goes out; one of rank 3
 * has half the distance of the first from the rim, and the second turned so
 * that light always comes from the same azimuth.  A node divides each
 * coordinate in two, or is a grid of 2^k values along each.
 *
 * Light from one direction meets a slice of the tree.  For drawing from it we
 * keep, for every cell of the finest resolution, running sums over
 * the 64 blocks of the outgoing square, along Hilbert's curve; within a block
 * the slice's few leaves are visited.  What the curve passes first is met first
 * by small random numbers. */
#include "config.h"

#include "scene/bsdfimpl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NEGLIGIBLE  (.01 / M_PI) /* a Lambertian rest below this is none */
#define IMPOSSIBLE  (1.5 / M_PI) /* and one from this on is no rest */
#define MAX_RES_LOG 8            /* cells of slices: Radiance's finest */
#define BLOCK_LOG   3
#define NBLOCKS     (1 << 2 * BLOCK_LOG)
#define TINY        1e-6 /* keeps the rim of isotropic trees off the middle */

struct node {
    int lg; /* of a grid: 2^lg values along each coordinate; -1: a branch */
    union {
        struct node **kid; /* bit i: upper half of coordinate i */
        float *value;      /* the last coordinate's are neighbours */
    } u;
};

/* The light of a cell, over pi, and which fraction of it lies before each block
 * along the curve. */
struct cell {
    double total;
    uint32_t before[NBLOCKS]; /* 2^32 would be all */
    uint8_t finest, coarsest; /* logs of 1 over a leaf's width */
};

struct slices {
    int res_log;
    bool reverse; /* light comes in where the tree has it go out */
    struct cell *cell;
};

enum { Y, U, V, NCHANNELS };

struct bsdf_tree {
    int rank;
    struct node *root[NCHANNELS]; /* U and V NULL: grey */
    int finest;                   /* log of 1 over the smallest leaf */
    double rest[3];               /* sharp channels, or Y in all */
    double rest_y;
    struct slices slices, reverse; /* the latter of rank 4, light passing */
};

/* --- finding the way -------------------------------------------------------
 */

/* A cell of a tree: a node, or a part of a node's grid. */
struct cursor {
    const struct node *n;
    int left; /* levels that are left of the grid */
    uint32_t at[4];
};

static struct cursor
start(const struct node *root)
{
    return (struct cursor){ root, root->lg, { 0 } };
}

static bool
at_leaf(const struct cursor *c)
{
    return c->left == 0;
}

/* Into a half along each coordinate. */
static void
descend(struct cursor *c, int rank, unsigned bits)
{
    if (c->n->lg < 0) {
        *c = start(c->n->u.kid[bits]);
        return;
    }
    c->left--;
    for (int i = 0; i < rank; i++)
        c->at[i] = c->at[i] << 1 | (bits >> i & 1);
}

static double
leaf_value(const struct cursor *c, int rank)
{
    size_t i = 0;

    for (int k = 0; k < rank; k++)
        i = i << c->n->lg | c->at[k];
    return (double)c->n->u.value[i];
}

/* The value at a place, and the cell that it lies in: its lowest corner, and
 * the log of 1 over its width.  The bits of a coordinate are the way down. */
static double
look_up(const struct node *n, int rank, const double place[4], double corner[4],
        int *level)
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

/* --- reading ---------------------------------------------------------------
 */

struct source {
    const char *p;
    struct rad_arena *arena;
    int rank;
    struct rad_error *err;
};

static int
next_mark(struct source *in)
{
    in->p += strspn(in->p, " \t\r\n");
    return *in->p;
}

static struct node *
bad_tree(struct source *in, const char *what)
{
    rad_fail(in->err, RAD_EDATA, "tensor tree: %s", what);
    return NULL;
}

/* How many numbers are there up to the brace? */
static size_t
count_values(const char *p)
{
    const char *end = p + strcspn(p, "{}");
    size_t n = 0;

    while (p < end) {
        p += strspn(p, " \t\r\n,");
        if (p < end)
            n++;
        p += strcspn(p, " \t\r\n,{}");
    }
    return n;
}

static struct node *
read_grid(struct source *in, struct node *n, int levels)
{
    size_t count = count_values(in->p);

    for (n->lg = 0; (size_t)1 << n->lg * in->rank < count; n->lg++)
        ;
    if ((size_t)1 << n->lg * in->rank != count)
        return bad_tree(in, "no power of two of values in a grid");
    if (n->lg > levels)
        return bad_tree(in, "divided too finely");
    n->u.value = rad_arena_alloc(in->arena, count * sizeof *n->u.value);
    if (!n->u.value)
        return bad_tree(in, "out of memory");
    for (size_t i = 0; i < count; i++) {
        double v;

        if (!rad_bsdf_number(&in->p, &v))
            return bad_tree(in, "expected a number");
        n->u.value[i] = (float)fmin(fmax(v, 0), 1e30);
    }
    return n;
}

static struct node *
read_node(struct source *in, int levels)
{
    struct node *n = rad_arena_calloc(in->arena, 1, sizeof *n);

    if (!n)
        return bad_tree(in, "out of memory");
    if (next_mark(in) != '{')
        return bad_tree(in, "expected '{'");
    in->p++;
    if (next_mark(in) == '{') {
        if (levels == 0)
            return bad_tree(in, "divided too finely");
        n->lg = -1;
        n->u.kid = rad_arena_calloc(in->arena, (size_t)1 << in->rank,
                                    sizeof *n->u.kid);
        if (!n->u.kid)
            return bad_tree(in, "out of memory");
        for (int i = 0; i < 1 << in->rank; i++) {
            n->u.kid[i] = read_node(in, levels - 1);
            if (!n->u.kid[i])
                return NULL;
        }
    } else if (!read_grid(in, n, levels)) {
        return NULL;
    }
    if (next_mark(in) != '}')
        return bad_tree(in, "expected '}'");
    in->p++;
    if (next_mark(in) == ',')
        in->p++;
    return n;
}

static int
read_block(struct rad_bsdf *b, struct rad_arena *arena,
           const struct xml_node *block, int channel, int rank,
           struct rad_error *err)
{
    struct source in = { rad_xml_text(block, "ScatteringData"), arena, rank,
                         err };
    int side = rad_bsdf_side(block);
    const char *basis = rad_xml_text(block, "AngleBasis");
    struct bsdf_tree *t;

    if (side < 0)
        return 0;
    if (strcasecmp(basis, "LBNL/Shirley-Chiu") != 0)
        return rad_fail(err, RAD_EUNSUPPORTED,
                        "angle basis '%.60s' of a tree is not supported",
                        basis);
    t = b->part[side].tree;
    if (!t)
        t = rad_arena_calloc(arena, 1, sizeof *t);
    if (!t)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    b->part[side].tree = t;
    t->rank = rank;
    t->root[channel] = read_node(&in, RAD_MAX_BSDF_LEVELS);
    if (!t->root[channel])
        return RAD_EDATA;
    return next_mark(&in)
               ? rad_fail(err, RAD_EDATA, "tensor tree: more behind its end")
               : 0;
}

/* --- colours ---------------------------------------------------------------
 */

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

/* The sharp channels of luminance y at a place. */
static void
channels(const struct bsdf_tree *t, double y, const double place[4],
         double c[3])
{
    double xyz[3];

    to_xyz(y, look_up(t->root[U], t->rank, place, NULL, NULL),
           look_up(t->root[V], t->rank, place, NULL, NULL), xyz);
    rad_bsdf_sharpen(c, xyz);
}

static double
value_y(const struct bsdf_tree *t, double y)
{
    return y > t->rest_y ? y - t->rest_y : 0;
}

/* --- what follows from the values ------------------------------------------
 */

/* Called for every leaf of the luminance. */
struct visitor {
    const struct bsdf_tree *t;
    void (*leaf)(void *arg, double value, const uint32_t at[4], int level);
    void *arg;
};

static void
visit(const struct visitor *v, const struct cursor *c, const uint32_t at[4],
      int level)
{
    if (at_leaf(c)) {
        v->leaf(v->arg, leaf_value(c, v->t->rank), at, level);
        return;
    }
    for (unsigned bits = 0; bits < 1u << v->t->rank; bits++) {
        struct cursor kid = *c;
        uint32_t place[4];

        descend(&kid, v->t->rank, bits);
        for (int i = 0; i < 4; i++)
            place[i] = at[i] << 1 | (bits >> i & 1);
        visit(v, &kid, place, level + 1);
    }
}

static void
visit_all(const struct bsdf_tree *t,
          void (*leaf)(void *, double, const uint32_t[4], int), void *arg)
{
    static const uint32_t origin[4];
    struct visitor v = { t, leaf, arg };
    struct cursor c = start(t->root[Y]);

    visit(&v, &c, origin, 0);
}

struct least {
    const struct bsdf_tree *t;
    double c[3];
    int finest;
};

/* Half of an isotropic tree means nothing: no direction is beyond the rim. */
static void
find_least(void *arg, double value, const uint32_t at[4], int level)
{
    struct least *least = arg;
    double c[3] = { value, value, value }, place[4];
    double size = ldexp(1, -level);

    if (level > least->finest)
        least->finest = level;
    for (int i = 0; i < 4; i++)
        place[i] = (at[i] + .5) * size;
    if (least->t->rank == 3 && level > 0 && place[0] >= .5)
        return;
    if (least->t->root[U])
        channels(least->t, value, place, c);
    for (int i = 0; i < 3; i++)
        least->c[i] = fmin(least->c[i], c[i]);
}

static void
take_rest(struct bsdf_tree *t, double diffuse[3])
{
    struct least least = { t, { INFINITY, INFINITY, INFINITY }, 0 };
    double xyz[3];

    visit_all(t, find_least, &least);
    t->finest = least.finest;
    if (t->root[U])
        rad_bsdf_unsharpen(xyz, least.c);
    else
        memcpy(xyz, least.c, sizeof xyz);
    if (!(xyz[1] > NEGLIGIBLE) || (!t->root[U] && xyz[1] >= IMPOSSIBLE))
        return;
    memcpy(t->rest, least.c, sizeof t->rest);
    t->rest_y = xyz[1];
    for (int k = 0; k < 3; k++)
        diffuse[k] = M_PI * xyz[k];
}

struct filler {
    const struct bsdf_tree *t;
    struct slices *s;
    double *sum; /* by cell and block, in rows */
};

/* Add a leaf's light to the blocks that it covers, of one cell. */
static void
fill_blocks(const struct filler *f, size_t cell, double value,
            const uint32_t out[2], int level)
{
    int k = level < BLOCK_LOG ? BLOCK_LOG - level : 0;
    double share = value * ldexp(1, -2 * (level + k));

    for (uint32_t x = 0; x < 1u << k; x++)
        for (uint32_t y = 0; y < 1u << k; y++) {
            uint32_t bx = out[0], by = out[1];

            if (level < BLOCK_LOG) {
                bx = bx << k | x;
                by = by << k | y;
            } else {
                bx >>= level - BLOCK_LOG;
                by >>= level - BLOCK_LOG;
            }
            f->sum[cell * NBLOCKS + (bx << BLOCK_LOG | by)] += share;
        }
}

static void
fill_cell(const struct filler *f, size_t cell, double value,
          const uint32_t out[2], int level)
{
    struct cell *c = &f->s->cell[cell];

    fill_blocks(f, cell, value, out, level);
    if (level > c->finest)
        c->finest = (uint8_t)level;
    if (level < c->coarsest)
        c->coarsest = (uint8_t)level;
}

/* The cells [*from, *to) whose middles a leaf covers along one coordinate. */
static void
covered(uint32_t at, int level, int res_log, uint32_t *from, uint32_t *to)
{
    if (level <= res_log) {
        *from = at << (res_log - level);
        *to = (at + 1) << (res_log - level);
    } else { /* a cell's middle lies at the lower end of one of the leaves */
        uint32_t half = 1u << (level - res_log - 1);

        *from = at >> (level - res_log);
        *to = *from + ((at & (2 * half - 1)) == half);
    }
}

static void
fill_leaf(void *arg, double value, const uint32_t at[4], int level)
{
    const struct filler *f = arg;
    int in = f->s->reverse ? 2 : 0, nin = f->t->rank - 2;
    uint32_t out[2], from[2] = { 0, 0 }, to[2] = { 1, 1 };

    for (int i = 0; i < 2; i++)
        out[i] = f->s->reverse ? (1u << level) - 1 - at[i] : at[nin + i];
    for (int i = 0; i < nin; i++) /* the only one of rank 3 counts columns */
        covered(at[in + i], level, f->s->res_log, &from[2 - nin + i],
                &to[2 - nin + i]);
    for (uint32_t x = from[0]; x < to[0]; x++)
        for (uint32_t y = from[1]; y < to[1]; y++)
            fill_cell(f, ((size_t)x << f->s->res_log) + y, value_y(f->t, value),
                      out, level);
}

static size_t
count_cells(const struct bsdf_tree *t, const struct slices *s)
{
    return (size_t)1 << s->res_log * (t->rank - 2);
}

/* Sums along the curve. */
static void
run_up(const double *block, struct cell *cell)
{
    double before[NBLOCKS];

    for (unsigned i = 0; i < NBLOCKS; i++) {
        struct hilbert h = HILBERT_START;
        unsigned bx = 0, by = 0, x, y;

        for (int k = BLOCK_LOG; k-- > 0;) {
            rad_hilbert_enter(&h, i >> 2 * k & 3, &x, &y);
            bx = bx << 1 | x;
            by = by << 1 | y;
        }
        before[i] = cell->total;
        cell->total += block[bx << BLOCK_LOG | by];
    }
    for (unsigned i = 0; i < NBLOCKS && cell->total > 0; i++)
        cell->before[i] =
            (uint32_t)fmin(before[i] / cell->total * 0x1p32, UINT32_MAX);
}

static int
make_slices(const struct bsdf_tree *t, struct slices *s,
            struct rad_arena *arena, bool reverse, struct rad_error *err)
{
    struct filler f = { t, s, NULL };
    size_t n;

    s->reverse = reverse;
    s->res_log = t->finest < MAX_RES_LOG ? t->finest : MAX_RES_LOG;
    n = count_cells(t, s);
    s->cell = rad_arena_calloc(arena, n, sizeof *s->cell);
    f.sum = calloc(n * NBLOCKS, sizeof *f.sum);
    if (!s->cell || !f.sum) {
        free(f.sum);
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    }
    for (size_t i = 0; i < n; i++)
        s->cell[i].coarsest = UINT8_MAX;
    visit_all(t, fill_leaf, &f);
    for (size_t i = 0; i < n; i++)
        run_up(f.sum + i * NBLOCKS, &s->cell[i]);
    free(f.sum);
    return 0;
}

/* The most that any direction scatters: of boxes of 1/32 or of the cells. */
static double
find_most(const struct bsdf_tree *t)
{
    const struct slices *s = &t->slices;
    int skip = s->res_log > 5 ? s->res_log - 5 : 0;
    int n = 1 << (s->res_log - skip), rows = t->rank == 4 ? n : 1;
    double most = 0;

    /* the outer half of an isotropic tree is beyond the rim */
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < (rows == 1 ? (n + 1) / 2 : n); j++) {
            double sum = 0;

            for (int a = 0; a < (rows == 1 ? 1 : 1 << skip); a++)
                for (int b = 0; b < 1 << skip; b++) {
                    size_t x = ((size_t)i << skip) + (size_t)a;
                    size_t y = ((size_t)j << skip) + (size_t)b;

                    sum += s->cell[(x << s->res_log) + y].total;
                }
            most = fmax(most, ldexp(sum, -skip * (t->rank - 2)));
        }
    return M_PI * most;
}

static int
finish(struct bsdf_part *p, struct rad_arena *arena, double diffuse[3],
       struct rad_error *err)
{
    struct bsdf_tree *t = p->tree;
    int rc;

    if (!t->root[Y]) {
        p->tree = NULL;
        return 0;
    }
    if (!t->root[U] || !t->root[V])
        t->root[U] = t->root[V] = NULL;
    take_rest(t, diffuse);
    p->finest = M_PI * ldexp(1, -2 * t->finest);
    rc = make_slices(t, &t->slices, arena, false, err);
    if (rc == 0 && t->rank == 4 && (p->side == SIDE_TF || p->side == SIDE_TB))
        rc = make_slices(t, &t->reverse, arena, true, err);
    if (rc == 0)
        p->most = find_most(t);
    return rc;
}

int
rad_bsdf_read_trees(struct rad_bsdf *b, struct rad_arena *arena,
                    const struct xml_node *layer, struct rad_error *err)
{
    const char *structure = rad_xml_text(rad_xml_kid(layer, "DataDefinition"),
                                         "IncidentDataStructure");
    static const char *const channels[NCHANNELS] = { "Visible", "CIE-u",
                                                     "CIE-v" };
    const struct xml_node *w = rad_xml_kid(layer, "WavelengthData");
    int rank = strcasecmp(structure, "TensorTree3") == 0   ? 3
               : strcasecmp(structure, "TensorTree4") == 0 ? 4
                                                           : 0;
    int rc = 0;

    if (!rank)
        return rad_fail(err, RAD_EUNSUPPORTED,
                        "IncidentDataStructure '%.60s' is not supported",
                        structure);
    for (; w && rc == 0; w = rad_xml_next(w)) {
        const struct xml_node *block = rad_xml_kid(w, "WavelengthDataBlock");
        int channel = rad_bsdf_which(w, "Wavelength", channels, NCHANNELS);

        for (; block && channel >= 0 && rc == 0; block = rad_xml_next(block))
            rc = read_block(b, arena, block, channel, rank, err);
    }
    for (int i = 0; i < NSIDES && rc == 0; i++)
        if (b->part[i].tree)
            rc = finish(&b->part[i], arena, b->diffuse[i], err);
    return rc;
}

/* --- looking up ------------------------------------------------------------
 */

static double
inside(double x)
{
    return x > 0 ? x < 1 ? x : 1 - 0x1p-53 : 0;
}

/* The arc tangent of t in [-1, 1], times 4 / pi, to 1e-13: reduced twice by
 * atan(t) = 2 atan(t / (1 + sqrt(1 + t^2))), then its series. */
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

/* Shirley and Chiu's map of the disk to the unit square: the longer coordinate
 * becomes the radius, the other its share by angle. */
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
    *x = r * cos(phi * (M_PI / 4));
    *y = r * sin(phi * (M_PI / 4));
}

/* The isotropic coordinate of light from v. */
static double
from_rim(const double v[3])
{
    return inside(.5 - TINY - .5 * sqrt(v[0] * v[0] + v[1] * v[1]));
}

/* A number about 1 that is another for each cell, so that who gets the same
 * value twice knows that it is the same cell, as in Radiance. */
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

/* Set what turns light from v into the half plane that isotropic trees are
 * for. */
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

/* Where light from the eye to `out` lies in an isotropic tree. */
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
        if (!(value_y(t, y) > 0))
            return;
        f = mark(t->rank, corner);
        xyz[0] = xyz[1] = xyz[2] = f * value_y(t, y);
        return;
    }
    f = mark(t->rank, corner);
    channels(t, y, place, c);
    for (int i = 0; i < 3; i++)
        c[i] = f * (t->rest_y > 0 ? fmax(c[i] - t->rest[i], 1e-5 * y) : c[i]);
    rad_bsdf_unsharpen(xyz, c);
}

/* The cell of the slice that light from the eye meets, and the place of its
 * middle.  NULL: there is none. */
static const struct cell *
find_slice(const struct rad_bsdf_way *w, double middle[2])
{
    const struct bsdf_tree *t = w->part->tree;
    const struct slices *s = w->swapped ? &t->reverse : &t->slices;
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
    const struct cell *c = find_slice(w, middle);

    if (!c)
        return;
    range[0] = fmin(range[0], M_PI * ldexp(1, -2 * c->finest));
    range[1] = fmax(range[1], M_PI * ldexp(1, -2 * c->coarsest));
}

double
rad_tree_total(const struct rad_bsdf_way *w)
{
    double middle[2];
    const struct cell *c = find_slice(w, middle);

    return c ? M_PI * c->total : 0;
}

/* --- drawing ---------------------------------------------------------------
 */

/* A walk along the curve through a slice. */
struct walk {
    const struct bsdf_tree *t;
    const struct slices *s;
    double left;   /* light to pass before the place is reached */
    double out[2]; /* that place */
};

struct step {
    struct cursor c;
    struct hilbert h;
    double in[2], low[2], size; /* low: corner of the outgoing cell */
};

/* Into quarter q of the outgoing square. */
static struct step
take_step(const struct walk *w, const struct step *from, unsigned q)
{
    struct step to = *from;
    unsigned bits = 0, xy[2], nin = (unsigned)w->t->rank - 2;

    rad_hilbert_enter(&to.h, q, &xy[0], &xy[1]);
    to.size /= 2;
    for (unsigned i = 0; i < 2; i++) {
        bool upper = from->in[i] >= .5;

        to.low[i] += xy[i] * to.size;
        to.in[i] = 2 * from->in[i] - upper;
        if (w->s->reverse)
            bits |= (unsigned)upper << (2 + i) | (xy[i] ^ 1) << i;
        else
            bits |= xy[i] << (nin + i);
        if (!w->s->reverse && (nin == 2 || i == 1))
            bits |= (unsigned)upper << (nin == 2 ? i : 0);
    }
    if (!at_leaf(&to.c))
        descend(&to.c, w->t->rank, bits);
    return to;
}

/* Walk through a cell.  True: the place is in it. */
static bool
walk_through(struct walk *w, const struct step *at)
{
    double light, p[2];

    if (!at_leaf(&at->c)) {
        for (unsigned q = 0; q < 4; q++) {
            struct step to = take_step(w, at, q);

            if (walk_through(w, &to))
                return true;
        }
        return false;
    }
    light = value_y(w->t, leaf_value(&at->c, w->t->rank)) * at->size * at->size;
    /* remembered for when rounding leads beyond the last */
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

/* The block that a fraction x of a slice's light leads into. */
static unsigned
find_block(const struct cell *c, double x)
{
    unsigned a = 0, b = NBLOCKS;

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
    struct step at = { .h = HILBERT_START, .size = 1 };
    const struct cell *c = find_slice(w, at.in);
    struct walk walk = { .t = t,
                         .s = w->swapped ? &t->reverse : &t->slices,
                         .out = { -1, -1 } };
    double px, py;
    unsigned block;

    if (!c || !(c->total > 0))
        return false;
    block = find_block(c, x);
    walk.left = fmax(x - c->before[block] * 0x1p-32, 0) * c->total;
    at.c = start(t->root[Y]);
    for (int k = BLOCK_LOG; k-- > 0;)
        at = take_step(&walk, &at, block >> 2 * k & 3);
    walk_through(&walk, &at);
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
