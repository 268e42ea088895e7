/* bsdftreeread.c - reading tensor trees, and what follows from their values:
 * the Lambertian rest and the sums for sampling */
#include "config.h"

#include "scene/bsdf/bsdftree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NEGLIGIBLE  (.01 / M_PI) /* a smaller Lambertian rest counts as none */
#define IMPOSSIBLE  (1.5 / M_PI) /* a rest cannot be this large */
#define MAX_RES_LOG 8            /* log2 of Radiance's finest resolution */

/* --- reading --- */

struct source {
    const char *p;
    struct rad_arena *arena;
    int rank;
    struct rad_error *err;
    int rc; /* why there is no node */
};

static int
next_mark(struct source *in)
{
    in->p += strspn(in->p, " \t\r\n");
    return *in->p;
}

static struct bsdf_node *
bad_tree(struct source *in, const char *what)
{
    in->rc = rad_fail(in->err, RAD_EDATA, "tensor tree: %s", what);
    return NULL;
}

static struct bsdf_node *
no_memory(struct source *in)
{
    in->rc = rad_fail_memory(in->err);
    return NULL;
}

/* The number of values before the next brace. */
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

static struct bsdf_node *
read_grid(struct source *in, struct bsdf_node *n, int levels)
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
        return no_memory(in);
    for (size_t i = 0; i < count; i++) {
        double v;

        if (!rad_bsdf_number(&in->p, &v))
            return bad_tree(in, "expected a number");
        n->u.value[i] = (float)fmin(fmax(v, 0), 1e30);
    }
    return n;
}

static struct bsdf_node *
read_node(struct source *in, int levels)
{
    struct bsdf_node *n = rad_arena_calloc(in->arena, 1, sizeof *n);

    if (!n)
        return no_memory(in);
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
            return no_memory(in);
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
                         err, 0 };
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
        return rad_fail_memory(err);
    b->part[side].tree = t;
    t->rank = rank;
    t->root[channel] = read_node(&in, RAD_MAX_BSDF_LEVELS);
    if (!t->root[channel])
        return in.rc;
    return next_mark(&in)
               ? rad_fail(err, RAD_EDATA, "tensor tree: more behind its end")
               : 0;
}

/* --- what follows from the values --- */

/* A function that is called for every leaf of the luminance. */
struct visitor {
    const struct bsdf_tree *t;
    void (*leaf)(void *arg, double value, const uint32_t at[4], int level);
    void *arg;
};

static void
visit(const struct visitor *v, const struct bsdf_cursor *c,
      const uint32_t at[4], int level)
{
    if (rad_tree_at_leaf(c)) {
        v->leaf(v->arg, rad_tree_leaf_value(c, v->t->rank), at, level);
        return;
    }
    for (unsigned bits = 0; bits < 1u << v->t->rank; bits++) {
        struct bsdf_cursor kid;
        uint32_t place[4];

        rad_tree_descend(c, v->t->rank, bits, &kid);
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
    struct bsdf_cursor c = rad_tree_start(t->root[Y]);

    visit(&v, &c, origin, 0);
}

struct least {
    const struct bsdf_tree *t;
    double c[3];
    int finest;
};

/* No direction is in the upper half of an isotropic tree: its values are left
 * out. */
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
        rad_tree_channels(least->t, value, place, c);
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
    struct bsdf_slices *s;
    double *sum; /* by cell and block, blocks in rows */
};

/* Add a leaf's light to the blocks that it covers, for one incident cell. */
static void
fill_blocks(const struct filler *f, size_t cell, double value,
            const uint32_t out[2], int level)
{
    int log = f->s->block_log, k = level < log ? log - level : 0;
    double share = value * ldexp(1, -2 * (level + k));
    double *sum = f->sum + (cell << 2 * log);

    for (uint32_t x = 0; x < 1u << k; x++)
        for (uint32_t y = 0; y < 1u << k; y++) {
            uint32_t bx = out[0], by = out[1];

            if (level < log) {
                bx = bx << k | x;
                by = by << k | y;
            } else {
                bx >>= level - log;
                by >>= level - log;
            }
            sum[bx << log | by] += share;
        }
}

static void
fill_cell(const struct filler *f, size_t cell, double value,
          const uint32_t out[2], int level)
{
    struct bsdf_cell *c = &f->s->cell[cell];

    fill_blocks(f, cell, value, out, level);
    if (level > c->finest)
        c->finest = (uint8_t)level;
    if (level < c->coarsest)
        c->coarsest = (uint8_t)level;
}

/* The incident cells [*from, *to) whose middles a leaf covers along one
 * coordinate. */
static void
covered(uint32_t at, int level, int res_log, uint32_t *from, uint32_t *to)
{
    if (level <= res_log) {
        *from = at << (res_log - level);
        *to = (at + 1) << (res_log - level);
    } else { /* a cell's middle is at the lower end of one of these leaves */
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
    for (int i = 0; i < nin; i++) /* with rank 3, the coordinate is the
                                   * column */
        covered(at[in + i], level, f->s->res_log, &from[2 - nin + i],
                &to[2 - nin + i]);
    for (uint32_t x = from[0]; x < to[0]; x++)
        for (uint32_t y = from[1]; y < to[1]; y++)
            fill_cell(f, ((size_t)x << f->s->res_log) + y,
                      rad_tree_above_rest(f->t, value), out, level);
}

/* Set order[i] to the index of the i-th block along the curve, by rows. */
static void
order_blocks(int log, uint16_t *order)
{
    for (unsigned i = 0; i < 1u << 2 * log; i++) {
        struct hilbert h = HILBERT_START;
        unsigned bx = 0, by = 0, x, y;

        for (int k = log; k-- > 0;) {
            rad_hilbert_enter(&h, i >> 2 * k & 3, &x, &y);
            bx = bx << 1 | x;
            by = by << 1 | y;
        }
        order[i] = (uint16_t)(bx << log | by);
    }
}

/* Make a cell's running sums over n blocks along the curve. */
static void
run_up(const double *block, const uint16_t *order, unsigned n,
       struct bsdf_cell *cell)
{
    double sum = 0;

    for (unsigned i = 0; i < n; i++)
        cell->total += block[order[i]];
    for (unsigned i = 0; i < n && cell->total > 0; i++) {
        cell->before[i] =
            (uint32_t)fmin(sum / cell->total * 0x1p32, UINT32_MAX);
        sum += block[order[i]];
    }
}

static int
make_slices(const struct bsdf_tree *t, struct bsdf_slices *s,
            struct rad_arena *arena, bool reverse, struct rad_error *err)
{
    struct filler f = { t, s, NULL };
    uint16_t order[1 << 2 * MOST_BLOCK_LOG];
    uint32_t *before;
    unsigned nblocks;
    size_t n;

    s->reverse = reverse;
    s->res_log = t->finest < MAX_RES_LOG ? t->finest : MAX_RES_LOG;
    s->block_log = t->rank == 3 ? MOST_BLOCK_LOG : BLOCK_LOG;
    nblocks = 1u << 2 * s->block_log;
    n = (size_t)1 << s->res_log * (t->rank - 2);
    s->cell = rad_arena_calloc(arena, n, sizeof *s->cell);
    before = rad_arena_calloc(arena, n * nblocks, sizeof *before);
    f.sum = calloc(n * nblocks, sizeof *f.sum);
    if (!s->cell || !before || !f.sum) {
        free(f.sum);
        return rad_fail_memory(err);
    }
    for (size_t i = 0; i < n; i++) {
        s->cell[i].coarsest = UINT8_MAX;
        s->cell[i].before = before + i * nblocks;
    }
    visit_all(t, fill_leaf, &f);
    order_blocks(s->block_log, order);
    for (size_t i = 0; i < n; i++)
        run_up(f.sum + i * nblocks, order, nblocks, &s->cell[i]);
    free(f.sum);
    return 0;
}

/* The largest share that is scattered, averaged over boxes of 1/32 or cells. */
static double
find_most(const struct bsdf_tree *t)
{
    const struct bsdf_slices *s = &t->slices;
    int skip = s->res_log > 5 ? s->res_log - 5 : 0;
    int n = 1 << (s->res_log - skip), rows = t->rank == 4 ? n : 1;
    double most = 0;

    /* no direction is in the upper half of an isotropic tree */
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
