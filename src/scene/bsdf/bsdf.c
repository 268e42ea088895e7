/* bsdf.c - see bsdf.h; bsdfmatrix.c and bsdftree.c have the two forms of
 * parts */
#include "config.h"

#include "scene/bsdf/bsdfimpl.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NEGLIGIBLE .001 /* a part that scatters no more has only its rest */

bool
rad_bsdf_number(const char **p, double *value)
{
    const char *s = *p;
    char *end;

    s += strspn(s, " \t\r\n");
    if (!*s || !strchr("+-.0123456789", *s) ||
        (s[0] == '0' && (s[1] == 'x' || s[1] == 'X')))
        return false;
    *value = strtod(s, &end);
    if (end == s || !isfinite(*value))
        return false;
    end += strspn(end, " \t\r\n");
    *p = *end == ',' ? end + 1 : end;
    return true;
}

void
rad_bsdf_sharpen(double sharp[3], const double xyz[3])
{
    sharp[0] = 1.2694 * xyz[0] - .0988 * xyz[1] - .1706 * xyz[2];
    sharp[1] = -.8364 * xyz[0] + 1.8006 * xyz[1] + .0357 * xyz[2];
    sharp[2] = .0297 * xyz[0] - .0315 * xyz[1] + 1.0018 * xyz[2];
}

void
rad_bsdf_unsharpen(double xyz[3], const double s[3])
{
    xyz[0] = .81563331 * s[0] + .0471547788 * s[1] + .137216627 * s[2];
    xyz[1] = .379114399 * s[0] + .576942425 * s[1] + .0440008704 * s[2];
    xyz[2] = -.0122601375 * s[0] + .016743052 * s[1] + .99551876 * s[2];
}

/* Every other bit of 64, from the lowest. */
static uint32_t
even_bits(uint64_t v)
{
    v &= 0x5555555555555555;
    v = (v | v >> 1) & 0x3333333333333333;
    v = (v | v >> 2) & 0x0f0f0f0f0f0f0f0f;
    v = (v | v >> 4) & 0x00ff00ff00ff00ff;
    v = (v | v >> 8) & 0x0000ffff0000ffff;
    return (uint32_t)(v | v >> 16);
}

/* For each bit the parity of those above it. */
static uint32_t
parity_above(uint32_t v)
{
    v ^= v >> 1;
    v ^= v >> 2;
    v ^= v >> 4;
    v ^= v >> 8;
    v ^= v >> 16;
    return v >> 1;
}

/* rad_hilbert_enter() for all levels at once, a bit each: the curve's axes are
 * exchanged, or mirrored, after an odd number of quarters that do so. */
void
rad_hilbert_point(struct hilbert h, double t, double p[2])
{
    enum { LEVELS = 26 }; /* all bits of t */
    const uint64_t last = (UINT64_C(1) << 2 * LEVELS) - 1;
    const uint32_t all = (UINT32_C(1) << LEVELS) - 1;
    uint64_t at = t < 1 ? (uint64_t)(t * 0x1p52) : last;
    uint32_t rx = even_bits(at >> 1), ry = even_bits(at) ^ rx;
    uint32_t swap = parity_above(~ry & all) ^ (h.swap ? all : 0);
    uint32_t flip = parity_above(~ry & rx) ^ (h.flip ? all : 0);
    uint32_t other = (rx ^ ry) & swap;

    p[0] = ((rx ^ other ^ flip) + .5) * 0x1p-26;
    p[1] = ((ry ^ other ^ flip) + .5) * 0x1p-26;
}

int
rad_bsdf_which(const struct xml_node *n, const char *kid,
               const char *const name[], int nnames)
{
    const char *text = rad_xml_text(n, kid);

    for (int i = 0; i < nnames; i++)
        if (strcasecmp(text, name[i]) == 0)
            return i;
    return -1;
}

/* The file's front is our back. */
int
rad_bsdf_side(const struct xml_node *block)
{
    static const char *const name[NSIDES] = { "Reflection Back",
                                              "Reflection Front",
                                              "Transmission Back",
                                              "Transmission Front" };

    return rad_bsdf_which(block, "WavelengthDataDirection", name, NSIDES);
}

static bool
is_there(const struct bsdf_part *p)
{
    return p->matrix || p->tree;
}

/* Transmission that the file gives for one side only is valid for both: let the
 * other side have the same rest.  Drop parts that scatter next to nothing. */
static void
settle(struct rad_bsdf *b)
{
    int given = is_there(&b->part[SIDE_TB]) ? SIDE_TB : SIDE_TF;
    int other = given == SIDE_TB ? SIDE_TF : SIDE_TB;

    if (!is_there(&b->part[other]))
        memcpy(b->diffuse[other], b->diffuse[given], sizeof b->diffuse[given]);
    for (int i = 0; i < NSIDES; i++)
        if (b->part[i].most <= NEGLIGIBLE)
            b->part[i].matrix = NULL, b->part[i].tree = NULL;
}

static int
read_layer(struct rad_bsdf *b, struct rad_arena *arena,
           const struct xml_node *root, struct rad_error *err)
{
    const struct xml_node *layer =
        rad_xml_kid(rad_xml_kid(root, "Optical"), "Layer");
    const char *structure;

    if (strcmp(root->name, "WindowElement") != 0)
        return rad_fail(err, RAD_EDATA, "top element is not WindowElement");
    if (rad_xml_kid(root, "FileType") &&
        strcmp(rad_xml_text(root, "FileType"), "BSDF") != 0)
        return rad_fail(err, RAD_EDATA, "FileType is not BSDF");
    if (!layer)
        return rad_fail(err, RAD_EDATA, "no optical layer");
    structure = rad_xml_text(rad_xml_kid(layer, "DataDefinition"),
                             "IncidentDataStructure");
    return strncasecmp(structure, "TensorTree", 10) == 0
               ? rad_bsdf_read_trees(b, arena, layer, err)
               : rad_bsdf_read_matrices(b, arena, layer, err);
}

struct rad_bsdf *
rad_bsdf_parse(struct rad_arena *arena, const char *xml, size_t len,
               struct rad_error *err)
{
    struct rad_bsdf *b = rad_arena_calloc(arena, 1, sizeof *b);
    const struct xml_node *root;
    struct rad_arena scratch;
    int rc;

    if (!b) {
        rad_fail_memory(err);
        return NULL;
    }
    for (int i = 0; i < NSIDES; i++)
        b->part[i].side = (enum side)i;
    rad_arena_init(&scratch);
    root = rad_xml_parse(&scratch, xml, len, err);
    rc = root ? read_layer(b, arena, root, err) : RAD_EDATA;
    rad_arena_release(&scratch);
    if (rc)
        return NULL;
    settle(b);
    return b;
}

/* --- questions to the right part --- */

/* The part, or NULL if there is only a rest.  Transmission is reciprocal, so
 * the other side's data serve as well. */
static const struct bsdf_part *
find_part(const struct rad_bsdf *b, bool front, bool through)
{
    const struct bsdf_part *p;

    if (!through)
        p = &b->part[front ? SIDE_RF : SIDE_RB];
    else if (is_there(&b->part[front ? SIDE_TF : SIDE_TB]))
        p = &b->part[front ? SIDE_TF : SIDE_TB];
    else
        p = &b->part[front ? SIDE_TB : SIDE_TF];
    return is_there(p) ? p : NULL;
}

bool
rad_bsdf_scatters(const struct rad_bsdf *b, bool front, bool through)
{
    return find_part(b, front, through) != NULL;
}

void
rad_bsdf_diffuse(const struct rad_bsdf *b, bool front, bool through,
                 double xyz[3])
{
    int side =
        through ? (front ? SIDE_TF : SIDE_TB) : (front ? SIDE_RF : SIDE_RB);

    memcpy(xyz, b->diffuse[side], sizeof b->diffuse[side]);
}

double
rad_bsdf_finest(const struct rad_bsdf *b, bool front, bool through)
{
    const struct bsdf_part *p = find_part(b, front, through);

    return p ? p->finest : M_PI;
}

double
rad_bsdf_most(const struct rad_bsdf *b, bool front, bool through)
{
    const struct bsdf_part *p = find_part(b, front, through);

    return p ? p->most : 0;
}

void
rad_bsdf_look_one_way(const struct rad_bsdf *b, const double in[3],
                      bool through, struct rad_bsdf_eye *eye)
{
    struct rad_bsdf_way *w = &eye->way[through];

    eye->b = b;
    memcpy(eye->v, in, sizeof eye->v);
    w->part = find_part(b, in[2] > 0, through);
    if (w->part && w->part->matrix)
        rad_matrix_look_from(w, in);
    else if (w->part)
        rad_tree_look_from(w, in);
}

void
rad_bsdf_look_from(const struct rad_bsdf *b, const double in[3],
                   struct rad_bsdf_eye *eye)
{
    rad_bsdf_look_one_way(b, in, false, eye);
    rad_bsdf_look_one_way(b, in, true, eye);
}

static void
scattered(const struct rad_bsdf_eye *eye, bool through, const double out[3],
          double xyz[3], double *cell)
{
    const struct rad_bsdf_way *w = &eye->way[through];

    if (w->part->matrix)
        rad_matrix_value(w, out, xyz, cell);
    else
        rad_tree_value(w, eye->v, out, xyz, cell);
}

void
rad_bsdf_value(const struct rad_bsdf_eye *eye, const double out[3],
               double xyz[3], double *cell)
{
    bool front = eye->v[2] > 0, through = front != (out[2] > 0);
    double more[3] = { 0, 0, 0 }, size = M_PI;

    rad_bsdf_diffuse(eye->b, front, through, xyz);
    if (eye->way[through].part)
        scattered(eye, through, out, more, &size);
    for (int i = 0; i < 3; i++)
        xyz[i] = xyz[i] / M_PI + more[i];
    if (cell)
        *cell = size;
}

void
rad_bsdf_cells(const struct rad_bsdf_eye *eye, double range[2])
{
    range[0] = INFINITY;
    range[1] = 0;
    for (int through = 0; through < 2; through++) {
        const struct rad_bsdf_way *w = &eye->way[through];

        if (w->part && w->part->matrix)
            rad_matrix_cells(w, eye->v, range);
        else if (w->part)
            rad_tree_cells(w, range);
    }
    if (!(range[0] < INFINITY))
        range[0] = range[1] = M_PI;
}

double
rad_bsdf_total(const struct rad_bsdf_eye *eye, bool through)
{
    const struct rad_bsdf_way *w = &eye->way[through];

    if (!w->part)
        return 0;
    return w->part->matrix ? rad_matrix_total(w) : rad_tree_total(w);
}

/* A smaller share of light counts as nothing, as in Radiance. */
#define NOTHING 1e-6

bool
rad_bsdf_sample(const struct rad_bsdf_eye *eye, bool through, double x,
                double out[3], double xyz[3])
{
    const struct rad_bsdf_way *w = &eye->way[through];
    double total = rad_bsdf_total(eye, through), value[3] = { 0, 0, 0 }, cell;

    if (!(total > NOTHING) ||
        !(w->part->matrix ? rad_matrix_sample(w, eye->v, x, out)
                          : rad_tree_sample(w, eye->v, x, out)))
        return false;
    scattered(eye, through, out, value, &cell); /* for its colour */
    for (int i = 0; i < 3; i++)
        xyz[i] = value[1] > 0 ? total * value[i] / value[1] : total;
    return true;
}
