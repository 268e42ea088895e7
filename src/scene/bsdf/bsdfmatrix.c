/* bsdfmatrix.c - scattering between the patches of two hemispheres
 *
 * A basis divides a hemisphere into rings by polar angle, and each ring evenly
 * by azimuth; the first patch of a ring is centred on azimuth 0.  Directions in
 * a patch are drawn evenly by projected solid angle.
 * As in Radiance, each value is multiplied by a factor within a thousandth of 1
 * that depends on the pair of patches.  So two values are equal only if they
 * are of the same pair, which shade/gloss/scatter.c relies on. */
#include "config.h"

#include "scene/bsdf/bsdfimpl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "arith/elementary.h"

#define NEGLIGIBLE (.01 / M_PI) /* a smaller Lambertian rest counts as none */

struct basis {
    const char *name;
    int nangles, nrings;
    struct ring {
        double theta; /* where it begins [degree] */
        int nphis;    /* number of patches; 0: the end, at 90 degrees */
    } ring[RAD_MAX_BSDF_RINGS + 1];
};

static const struct basis klems[] = {
    { "LBNL/Klems Full",
      145,
      9,
      { { 0, 1 },
        { 5, 8 },
        { 15, 16 },
        { 25, 20 },
        { 35, 24 },
        { 45, 24 },
        { 55, 24 },
        { 65, 16 },
        { 75, 12 },
        { 90, 0 } } },
    { "LBNL/Klems Half",
      77,
      7,
      { { 0, 1 },
        { 6.5, 8 },
        { 19.5, 12 },
        { 32.5, 16 },
        { 45.5, 20 },
        { 58.5, 12 },
        { 71.5, 8 },
        { 90, 0 } } },
    { "LBNL/Klems Quarter",
      41,
      5,
      { { 0, 1 }, { 9, 8 }, { 27, 12 }, { 45, 12 }, { 63, 8 }, { 90, 0 } } },
};

/* A basis as find_patch() needs it. */
struct rings {
    int n;
    double lower[RAD_MAX_BSDF_RINGS]; /* cosine of the angle where it ends */
    double size[RAD_MAX_BSDF_RINGS];  /* projected solid angle of its patches */
    int nphis[RAD_MAX_BSDF_RINGS];
    int first[RAD_MAX_BSDF_RINGS]; /* its first patch */
};

enum { Y, X, Z, NCHANNELS };

struct bsdf_matrix {
    const struct basis *in, *out;
    struct rings rin, rout;  /* of these bases */
    float *value[NCHANNELS]; /* [out * in->nangles + in]; X and Z NULL: grey */
    double rest[3];          /* subtracted: sharp channels; Y in all if grey */
    double rest_y;           /* luminance of the rest */
    double *sum[2];          /* running sums of values times solid angles: for
                              * each in over all out (nangles + 1 numbers), and
                              * the reverse */
};

/* --- directions and patches ----------------------------------------------- */

/* The patch of a direction with z >= 0; -1: none.  Comparing cosines saves an
 * arc cosine. */
static int
find_patch(const struct rings *b, double x, double y, double z)
{
    int ring = 0, at;
    double phi;

    if (!(z >= 0 && z <= 1.00001))
        return -1;
    while (ring < b->n && z <= b->lower[ring])
        ring++;
    if (ring == b->n)
        return -1;
    if (b->nphis[ring] == 1)
        return b->first[ring];
    phi = rad_atan2(y, x) / (2 * M_PI);
    at = (int)((phi < 0 ? phi + 1 : phi) * b->nphis[ring] + .5);
    return b->first[ring] + (at >= b->nphis[ring] ? 0 : at);
}

/* The incident patch of light that comes along v, which points away from the
 * surface. */
static int
find_in(const struct bsdf_matrix *m, enum side side, const double v[3])
{
    double sign = side == SIDE_RF || side == SIDE_TF ? 1 : -1;

    return find_patch(&m->rin, -v[0], -v[1], sign * v[2]);
}

static int
find_out(const struct bsdf_matrix *m, enum side side, const double v[3])
{
    double sign = side == SIDE_RF || side == SIDE_TB ? 1 : -1;

    return find_patch(&m->rout, v[0], v[1], sign * v[2]);
}

/* The ring of a patch; *patch becomes its index in the ring. */
static int
find_ring(const struct basis *b, int *patch)
{
    int ring = 0;

    for (; *patch >= b->ring[ring].nphis; ring++)
        *patch -= b->ring[ring].nphis;
    return ring;
}

static double
cos_squared(double degrees)
{
    double c = rad_cos(degrees * (M_PI / 180));

    return c * c;
}

/* The projected solid angle of a patch; 0 for -1. */
static double
patch_size(const struct basis *b, int patch)
{
    int ring;

    if (patch < 0)
        return 0;
    ring = find_ring(b, &patch);
    return M_PI *
           (cos_squared(b->ring[ring].theta) -
            cos_squared(b->ring[ring + 1].theta)) /
           b->ring[ring].nphis;
}

static void
prepare_rings(struct rings *r, const struct basis *b)
{
    int first = 0;

    r->n = b->nrings;
    for (int i = 0; i < b->nrings; i++) {
        r->lower[i] = rad_cos(b->ring[i + 1].theta * (M_PI / 180));
        r->nphis[i] = b->ring[i].nphis;
        r->size[i] = patch_size(b, first);
        r->first[i] = first;
        first += b->ring[i].nphis;
    }
}

/* The same, from struct rings. */
static double
ring_size(const struct rings *r, int patch)
{
    int i = r->n - 1;

    if (patch < 0)
        return 0;
    while (patch < r->first[i])
        i--;
    return r->size[i];
}

/* The direction, z positive, after a fraction t of a curve through a patch. */
static void
patch_direction(const struct basis *b, int patch, double t, double v[3])
{
    int ring = find_ring(b, &patch);
    double p[2], c2, s, phi;

    rad_hilbert_point(HILBERT_START, t, p);
    c2 = (1 - p[0]) * cos_squared(b->ring[ring].theta) +
         p[0] * cos_squared(b->ring[ring + 1].theta);
    phi = 2 * M_PI * (patch + p[1] - .5) / b->ring[ring].nphis;
    s = sqrt(fmax(1 - c2, 0));
    v[0] = rad_cos(phi) * s;
    v[1] = rad_sin(phi) * s;
    v[2] = sqrt(c2);
}

/* --- reading --- */

struct bases {
    struct basis *own[RAD_MAX_BSDF_BASES];
    int n;
};

static const struct basis *
find_basis(const struct bases *bases, const char *name)
{
    for (int i = bases->n; i-- > 0;)
        if (strcasecmp(bases->own[i]->name, name) == 0)
            return bases->own[i];
    for (size_t i = 0; i < sizeof klems / sizeof klems[0]; i++)
        if (strcasecmp(klems[i].name, name) == 0)
            return &klems[i];
    return NULL;
}

static double
read_angle(const struct xml_node *block, const char *name)
{
    return strtod(rad_xml_text(rad_xml_kid(block, "ThetaBounds"), name), NULL);
}

static int
read_rings(struct basis *b, const struct xml_node *block, struct rad_error *err)
{
    double end = 0;

    for (; block; block = rad_xml_next(block)) {
        double lower = read_angle(block, "LowerTheta");
        double upper = read_angle(block, "UpperTheta");
        long nphis = strtol(rad_xml_text(block, "nPhis"), NULL, 10);

        if (b->nrings == RAD_MAX_BSDF_RINGS)
            return rad_fail(err, RAD_EDATA, "too many rings in basis '%s'",
                            b->name);
        if (b->nrings > 0 && !(fabs(lower - end) <= 1e-6 * end))
            return rad_fail(err, RAD_EDATA, "angles disagree in basis '%s'",
                            b->name);
        if (!(upper > end && upper <= 90.0001))
            return rad_fail(err, RAD_EDATA, "bad angle in basis '%s'", b->name);
        if (nphis < 1 || nphis > RAD_MAX_BSDF_ANGLES - b->nangles ||
            (nphis == 1 && b->nrings > 0))
            return rad_fail(err, RAD_EDATA, "bad nPhis in basis '%s'", b->name);
        b->ring[b->nrings++] = (struct ring){ end, (int)nphis };
        b->nangles += (int)nphis;
        end = upper;
    }
    b->ring[b->nrings].theta = end;
    return b->nrings ? 0
                     : rad_fail(err, RAD_EDATA, "basis '%s' is empty", b->name);
}

/* Read the bases that a file defines; names that we know keep our meaning. */
static int
read_bases(struct bases *bases, struct rad_arena *arena,
           const struct xml_node *layer, struct rad_error *err)
{
    const struct xml_node *n =
        rad_xml_kid(rad_xml_kid(layer, "DataDefinition"), "AngleBasis");

    for (; n; n = rad_xml_next(n)) {
        const char *name = rad_xml_text(n, "AngleBasisName");
        struct basis *b;
        int rc;

        if (!*name || find_basis(bases, name))
            continue;
        if (bases->n == RAD_MAX_BSDF_BASES)
            return rad_fail(err, RAD_EDATA, "too many angle bases");
        b = rad_arena_calloc(arena, 1, sizeof *b);
        if (b)
            b->name = rad_arena_strndup(arena, name, strlen(name));
        if (!b || !b->name)
            return rad_fail_memory(err);
        rc = read_rings(b, rad_xml_kid(n, "AngleBasisBlock"), err);
        if (rc)
            return rc;
        bases->own[bases->n++] = b;
    }
    return 0;
}

static int
read_values(const struct xml_node *block, bool rows, struct bsdf_matrix *m,
            float *value, struct rad_error *err)
{
    const char *p = rad_xml_text(block, "ScatteringData");
    int nin = m->in->nangles, nout = m->out->nangles;

    for (int i = 0; i < nin * nout; i++) {
        double v;
        int at = rows ? i % nout * nin + i / nout : i;

        if (!rad_bsdf_number(&p, &v))
            return rad_fail(err, RAD_EDATA,
                            "value %d of %d is missing or no number", i + 1,
                            nin * nout);
        value[at] = (float)fmin(fmax(v, 0), 1e30);
    }
    return 0;
}

/* Read a block: one channel of one part.  It replaces an earlier block. */
static int
read_block(struct rad_bsdf *b, struct rad_arena *arena,
           const struct bases *bases, const struct xml_node *block, int channel,
           bool rows, struct rad_error *err)
{
    const char *column = rad_xml_text(block, "ColumnAngleBasis");
    const char *row = rad_xml_text(block, "RowAngleBasis");
    const struct basis *in = find_basis(bases, column);
    const struct basis *out = find_basis(bases, row);
    int side = rad_bsdf_side(block);
    struct bsdf_matrix *m;

    if (side < 0)
        return 0;
    if (!in || !out)
        return rad_fail(err, RAD_EDATA, "no angle basis '%.60s'",
                        in ? row : column);
    m = b->part[side].matrix;
    if (!m)
        m = rad_arena_calloc(arena, 1, sizeof *m);
    if (!m)
        return rad_fail_memory(err);
    if (b->part[side].matrix && (m->in != in || m->out != out))
        return rad_fail(err, RAD_EDATA, "channels of different bases");
    b->part[side].matrix = m;
    m->in = in;
    m->out = out;
    m->value[channel] =
        rad_arena_alloc(arena, (size_t)in->nangles * (size_t)out->nangles *
                                   sizeof *m->value[channel]);
    if (!m->value[channel])
        return rad_fail_memory(err);
    return read_values(block, rows, m, m->value[channel], err);
}

/* --- what follows from the values --- */

/* The factor for a pair of patches, within 3e-4 of 1 and different for each
 * pair, by Radiance's formula. */
static double
mark(const struct bsdf_matrix *m, int in, int out)
{
    double d = 2 * m->in->nangles / (in + .22545) +
               4 * m->out->nangles / (out + .70281);

    return 1 + 6e-4 * (d - (int)d - .5);
}

/* The value of two patches with the rest: sharp channels if it has colour, else
 * Y in all. */
static void
channels(const struct bsdf_matrix *m, int in, int out, double c[3])
{
    size_t i = (size_t)out * (size_t)m->in->nangles + (size_t)in;
    double y = (double)m->value[Y][i], f = mark(m, in, out);

    if (m->value[X]) {
        double xyz[3] = { f * (double)m->value[X][i], f * y,
                          f * (double)m->value[Z][i] };

        rad_bsdf_sharpen(c, xyz);
    } else {
        c[0] = c[1] = c[2] = f * y;
    }
}

/* Subtract the minimum of each channel as the rest, if it is enough light. */
static void
take_rest(struct bsdf_matrix *m, double diffuse[3])
{
    double least[3] = { INFINITY, INFINITY, INFINITY }, c[3], xyz[3];

    for (int i = 0; i < m->in->nangles; i++)
        for (int o = 0; o < m->out->nangles; o++) {
            channels(m, i, o, c);
            for (int k = 0; k < 3; k++)
                least[k] = fmin(least[k], c[k]);
        }
    if (m->value[X])
        rad_bsdf_unsharpen(xyz, least);
    else
        memcpy(xyz, least, sizeof xyz);
    if (!(xyz[1] > NEGLIGIBLE))
        return;
    memcpy(m->rest, least, sizeof m->rest);
    m->rest_y = xyz[1];
    for (int k = 0; k < 3; k++)
        diffuse[k] = M_PI * xyz[k];
}

/* The photopic value of two patches, without rest and factor. */
static double
value_y(const struct bsdf_matrix *m, int in, int out)
{
    return (double)
               m->value[Y][(size_t)out * (size_t)m->in->nangles + (size_t)in] -
           m->rest_y;
}

/* Make the running sums for each incident patch; reverse: for each outgoing
 * one. */
static double *
sum_up(const struct bsdf_matrix *m, struct rad_arena *arena, bool reverse)
{
    const struct basis *from = reverse ? m->out : m->in;
    const struct basis *to = reverse ? m->in : m->out;
    size_t n = (size_t)to->nangles + 1;
    double *sum =
        rad_arena_alloc(arena, (size_t)from->nangles * n * sizeof *sum);

    for (int i = 0; sum && i < from->nangles; i++) {
        double *row = sum + (size_t)i * n;
        double total = 0;

        row[0] = 0;
        for (int k = 0; k < to->nangles; k++) {
            double v = reverse ? value_y(m, k, i) : value_y(m, i, k);

            total += fmax(v, 0) * patch_size(to, k);
            row[k + 1] = total;
        }
    }
    return sum;
}

static double
smallest_patch(const struct basis *b)
{
    double least = M_PI;

    for (int i = 0; i < b->nangles; i++)
        least = fmin(least, patch_size(b, i));
    return least;
}

static int
finish(struct bsdf_part *p, struct rad_arena *arena, double diffuse[3],
       struct rad_error *err)
{
    struct bsdf_matrix *m = p->matrix;

    if (!m->value[Y]) { /* without luminance the part is dropped */
        p->matrix = NULL;
        return 0;
    }
    if (!m->value[X] || !m->value[Z])
        m->value[X] = m->value[Z] = NULL;
    prepare_rings(&m->rin, m->in);
    prepare_rings(&m->rout, m->out);
    take_rest(m, diffuse);
    p->finest = fmin(smallest_patch(m->in), smallest_patch(m->out));
    for (int reverse = 0; reverse < 2; reverse++) {
        m->sum[reverse] = sum_up(m, arena, reverse);
        if (!m->sum[reverse])
            return rad_fail_memory(err);
    }
    for (int i = 0; i < m->in->nangles; i++)
        p->most = fmax(
            p->most,
            (double)
                m->sum[0][(size_t)(i + 1) * ((size_t)m->out->nangles + 1) - 1]);
    return 0;
}

int
rad_bsdf_read_matrices(struct rad_bsdf *b, struct rad_arena *arena,
                       const struct xml_node *layer, struct rad_error *err)
{
    const char *structure = rad_xml_text(rad_xml_kid(layer, "DataDefinition"),
                                         "IncidentDataStructure");
    bool rows = strcasecmp(structure, "Rows") == 0;
    static const char *const channels[NCHANNELS] = { "Visible", "CIE-X",
                                                     "CIE-Z" };
    const struct xml_node *w = rad_xml_kid(layer, "WavelengthData");
    struct bases bases = { .n = 0 };
    int rc;

    if (!*structure)
        return rad_fail(err, RAD_EDATA, "no IncidentDataStructure");
    if (!rows && strcasecmp(structure, "Columns") != 0)
        return rad_fail(err, RAD_EUNSUPPORTED,
                        "IncidentDataStructure '%.60s' is not supported",
                        structure);
    rc = read_bases(&bases, arena, layer, err);
    for (; w && rc == 0; w = rad_xml_next(w)) {
        const struct xml_node *block = rad_xml_kid(w, "WavelengthDataBlock");
        int channel = rad_bsdf_which(w, "Wavelength", channels, NCHANNELS);

        for (; block && channel >= 0 && rc == 0; block = rad_xml_next(block))
            rc = read_block(b, arena, &bases, block, channel, rows, err);
    }
    for (int i = 0; i < NSIDES && rc == 0; i++)
        if (b->part[i].matrix)
            rc = finish(&b->part[i], arena, b->diffuse[i], err);
    return rc;
}

/* --- looking up --- */

void
rad_matrix_look_from(struct rad_bsdf_way *w, const double v[3])
{
    const struct bsdf_matrix *m = w->part->matrix;

    w->patch = find_in(m, w->part->side, v);
    w->swapped = w->patch < 0;
    if (w->swapped) /* reciprocity */
        w->patch = find_out(m, w->part->side, v);
}

static double
smaller_of(double a, double b)
{
    return a > 0 && (a < b || !(b > 0)) ? a : b;
}

void
rad_matrix_value(const struct rad_bsdf_way *w, const double out[3],
                 double xyz[3], double *cell)
{
    const struct bsdf_matrix *m = w->part->matrix;
    int i = w->swapped ? find_in(m, w->part->side, out) : w->patch;
    int o = w->swapped ? w->patch : find_out(m, w->part->side, out);
    double c[3];

    if (i < 0 || o < 0)
        return;
    *cell = smaller_of(ring_size(&m->rin, i), ring_size(&m->rout, o));
    if (!m->value[X]) {
        xyz[0] = xyz[1] = xyz[2] = value_y(m, i, o) * mark(m, i, o);
        return;
    }
    channels(m, i, o, c);
    for (int k = 0; k < 3; k++)
        c[k] -= m->rest[k];
    rad_bsdf_unsharpen(xyz, c);
}

void
rad_matrix_cells(const struct rad_bsdf_way *w, const double in[3],
                 double range[2])
{
    const struct bsdf_matrix *m = w->part->matrix;
    double size[2] = { ring_size(&m->rout, find_out(m, w->part->side, in)),
                       ring_size(&m->rin, find_in(m, w->part->side, in)) };

    for (int k = 0; k < 2; k++) {
        if (size[k] > 0)
            range[0] = fmin(range[0], size[k]);
        range[1] = fmax(range[1], size[k]);
    }
}

/* The running sums for w's direction, over the patches of *to; NULL: it is in
 * no patch. */
static const double *
find_sums(const struct rad_bsdf_way *w, const struct basis **to)
{
    const struct bsdf_matrix *m = w->part->matrix;

    if (w->patch < 0)
        return NULL;
    *to = w->swapped ? m->in : m->out;
    return m->sum[w->swapped] + (size_t)w->patch * ((size_t)(*to)->nangles + 1);
}

double
rad_matrix_total(const struct rad_bsdf_way *w)
{
    const struct basis *to;
    const double *sum = find_sums(w, &to);

    return sum ? sum[to->nangles] : 0;
}

/* Turn a direction with z > 0 in the basis that the light goes to into the
 * frame of the surface. */
static void
face(const struct rad_bsdf_way *w, const double in[3], double v[3])
{
    enum side side = w->part->side;

    if ((in[2] > 0) == (side == SIDE_TF || side == SIDE_TB))
        v[2] = -v[2];
    if (w->swapped) {
        v[0] = -v[0];
        v[1] = -v[1];
    }
}

bool
rad_matrix_sample(const struct rad_bsdf_way *w, const double in[3], double x,
                  double out[3])
{
    const struct basis *to;
    const double *sum = find_sums(w, &to);
    int lo = 0, hi;
    double target, share;

    if (!sum || !(sum[to->nangles] > 0))
        return false;
    target = x * sum[to->nangles];
    for (hi = to->nangles; hi - lo > 1;) {
        int mid = (lo + hi) / 2;

        if (target >= sum[mid])
            lo = mid;
        else
            hi = mid;
    }
    share = sum[lo + 1] - sum[lo];
    share = share > 0 ? (target - sum[lo]) / share : .5;
    patch_direction(to, lo, fmin(fmax(share, 0), 1), out);
    face(w, in, out);
    return true;
}
