/* check.c - do a scene's objects satisfy the rules of their types?
 *
 * First each object by itself: a table has the counts of its arguments, and a
 * function for further rules of its type.  Then each surface's chain of
 * modifiers: does it lead to at most one material?  An object refers only to
 * objects that were defined before it, so a pass over the array answers this
 * without recursion.
 * Problems of a modifier that no surface uses are only warnings, because
 * libraries of materials have many of them.  An object that Radiance leaves out
 * of a scene with a warning is left out here, too.
 * Source: Radiance's reference manual, "Scene description", and what its
 * renderers refuse. */
#include "config.h"

#include "base/vec.h"
#include "scene/part.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct checker {
    const struct rad_scene *scene;
    void (*each)(void *arg, const struct rad_error *err);
    void *arg;
    struct rad_error *err; /* the first problem */
    int rc;                /* its code */
    uint8_t *reached;      /* by object: does a surface lead to it? */
    int32_t *material;     /* by object: where its chain of modifiers ends */
    int32_t *depth;        /* by object: rad_scene_nesting() */
};

/* Report a problem of object o: to `each`, and in c->err if it is the first.  A
 * problem of a modifier that no surface uses becomes a warning. */
__attribute__((format(printf, 4, 5))) static void
report(struct checker *c, const struct rad_object *o, int code, const char *fmt,
       ...)
{
    struct rad_error err = { 0 };
    bool used =
        rad_otype_is_surface(o->type) || c->reached[o - c->scene->objects];
    char text[sizeof err.what];
    va_list ap;

    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    rad_scene_fail(c->scene, o, &err, used ? code : RAD_WARNING, "%s%s", text,
                   used ? "" : "; no surface uses it");
    if (err.code != RAD_WARNING && c->rc == 0) {
        c->rc = code;
        if (c->err && c->err->code == 0)
            *c->err = err;
    }
    if (c->each)
        c->each(c->arg, &err);
}

/* Corners of a polygon may be this far off its plane, in widths of the polygon,
 * without a warning: rounding in text files is less, and cannot be seen. */
#define UNEVEN 1e-3

/* --- one object ------------------------------------------------------- */

static bool
zero_vector(const double v[3])
{
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* Twice a polygon's area as a vector, in the direction of its normal. */
static void
area_vector(const double *v, int n, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 2; i < n; i++) {
        const double *a = v + 3 * (i - 1), *b = v + 3 * i;

        for (int x = 0; x < 3; x++) {
            int y = (x + 1) % 3, z = (x + 2) % 3;

            sum[x] +=
                (a[y] - v[y]) * (b[z] - v[z]) - (a[z] - v[z]) * (b[y] - v[y]);
        }
    }
}

/* The largest distance of a corner from the mean plane normal to area, divided
 * by the largest distance between the first corner and another. */
static double
unevenness(const double *v, int n, const double area[3])
{
    double mean = 0, off = 0, wide = 0, norm[3];

    rad_copy(norm, area);
    rad_normalize(norm);
    for (int i = 0; i < n; i++) {
        double d[3];

        rad_sub(d, v + 3 * (size_t)i, v);
        mean += rad_dot(norm, d) / n;
        wide = rad_most(wide, sqrt(rad_dot(d, d)));
    }
    for (int i = 0; i < n; i++) {
        double d[3];

        rad_sub(d, v + 3 * (size_t)i, v);
        off = rad_most(off, fabs(rad_dot(norm, d) - mean));
    }
    return off / wide;
}

static void
check_polygon(struct checker *c, const struct rad_object *o)
{
    int n = o->nreals / 3;
    double area[3];

    if (o->nreals % 3) {
        report(c, o, RAD_EDATA,
               "expected three real arguments for each vertex, got %d",
               (int)o->nreals);
        return;
    }
    if (strcmp(o->name, RAD_MESH_FACE) == 0)
        return;
    area_vector(o->reals, n, area);
    if (zero_vector(area))
        report(c, o, RAD_WARNING, "zero area: it is left out");
    else if (n > 3 && unevenness(o->reals, n, area) > UNEVEN)
        report(c, o, RAD_WARNING,
               "corners that are not in one plane: it is made flat");
}

static void
check_sphere(struct checker *c, const struct rad_object *o)
{
    if (o->reals[3] == 0)
        report(c, o, RAD_WARNING, "zero radius: it is left out");
    else if (o->reals[3] < 0)
        report(c, o, RAD_WARNING, "negative radius: it is turned inside out");
}

bool
rad_object_radii_fit(const struct rad_object *o)
{
    double r0 = o->reals[6], r1 = o->reals[7];

    if (o->type == RAD_RING)
        return r0 >= 0 && r1 >= 0;
    return !((r0 < 0 && r1 > 0) || (r0 > 0 && r1 < 0));
}

enum rad_otype
rad_object_shape(const struct rad_object *o)
{
    const double *r = o->reals;

    switch (o->type) {
    case RAD_SPHERE:
        return o->nreals > 3 && r[3] < 0 ? RAD_BUBBLE : RAD_SPHERE;
    case RAD_BUBBLE:
        return o->nreals > 3 && r[3] < 0 ? RAD_SPHERE : RAD_BUBBLE;
    case RAD_CYLINDER:
        return o->nreals > 6 && r[6] < 0 ? RAD_TUBE : RAD_CYLINDER;
    case RAD_TUBE:
        return o->nreals > 6 && r[6] < 0 ? RAD_CYLINDER : RAD_TUBE;
    case RAD_CONE:
        return o->nreals > 7 && r[6] == r[7] && r[6] > 0 ? RAD_CYLINDER
                                                         : RAD_CONE;
    case RAD_CUP:
        return o->nreals > 7 && r[6] == r[7] && r[6] < 0 ? RAD_CYLINDER
                                                         : RAD_CUP;
    default:
        return o->type;
    }
}

/* Cone, cup, cylinder and tube. */
static void
check_cone(struct checker *c, const struct rad_object *o)
{
    double r0 = o->reals[6], r1 = o->nreals > 7 ? o->reals[7] : r0;

    if (o->nreals > 7 && !rad_object_radii_fit(o))
        report(c, o, RAD_WARNING, "radii of opposite sign: it is left out");
    else if (r0 == 0 && r1 == 0)
        report(c, o, RAD_WARNING, "zero radius: it is left out");
    else if (memcmp(o->reals, o->reals + 3, 3 * sizeof *o->reals) == 0)
        report(c, o, RAD_WARNING, "zero length: it is left out");
    else if (r0 < 0 || r1 < 0)
        report(c, o, RAD_WARNING, "negative radius: it is turned inside out");
}

static void
check_ring(struct checker *c, const struct rad_object *o)
{
    if (!rad_object_radii_fit(o))
        report(c, o, RAD_WARNING, "negative radius: it is left out");
    else if (o->reals[6] == o->reals[7])
        report(c, o, RAD_WARNING, "equal radii: it is left out");
    else if (zero_vector(o->reals + 3))
        report(c, o, RAD_WARNING, "zero direction: it is left out");
}

static void
check_spotlight(struct checker *c, const struct rad_object *o)
{
    if (o->reals[3] <= 0)
        report(c, o, RAD_EDATA, "angle %g is not above 0", o->reals[3]);
    if (zero_vector(o->reals + 4))
        report(c, o, RAD_EDATA, "zero direction");
}

static void
check_glass(struct checker *c, const struct rad_object *o)
{
    if (o->nreals == 4 && o->reals[3] <= 0)
        report(c, o, RAD_EDATA, "refractive index %g is not above 0",
               o->reals[3]);
}

/* Check the wavelengths of a spectrum's ends. */
static void
check_range(struct checker *c, const struct rad_object *o)
{
    if (!(o->reals[0] > 0) || !(o->reals[1] > 0) || o->reals[0] == o->reals[1])
        report(c, o, RAD_EDATA, "no wavelengths from %g to %g nm", o->reals[0],
               o->reals[1]);
}

static void
check_interface(struct checker *c, const struct rad_object *o)
{
    if (o->reals[3] <= 0 || o->reals[7] <= 0)
        report(c, o, RAD_EDATA, "refractive index is not above 0");
}

/* Right and down must span a plane.  The cross product of parallel vectors is
 * zero but for its rounding, a few units in the last place of |R||D|. */
static void
check_text(struct checker *c, const struct rad_object *o)
{
    const double *r = o->reals + 3, *d = o->reals + 6;
    double n[3] = { r[1] * d[2] - r[2] * d[1], r[2] * d[0] - r[0] * d[2],
                    r[0] * d[1] - r[1] * d[0] };
    double rr = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];

    if (!(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 1e-30 * rr * dd))
        report(c, o, RAD_EDATA, "right and down vectors are parallel");
}

/* Radiance divides by the roughness only above this. */
#define LEAST_ROUGHNESS 1e-6

static void
check_rough(struct checker *c, const struct rad_object *o)
{
    if (!(o->reals[4] > LEAST_ROUGHNESS && o->reals[5] > LEAST_ROUGHNESS))
        report(c, o, RAD_EDATA, "roughness %g %g is not above 0", o->reals[4],
               o->reals[5]);
}

/* There is no lobe with a power of -1 or less. */
static void
check_powers(struct checker *c, const struct rad_object *o)
{
    if (!(o->reals[6] > -1 && o->reals[7] > -1))
        report(c, o, RAD_EDATA, "power %g %g is not above -1", o->reals[6],
               o->reals[7]);
}

/* Each of the first n string arguments must name a modifier defined before. */
static void
check_names(struct checker *c, const struct rad_object *o, int n)
{
    int32_t index = (int32_t)(o - c->scene->objects), mod;

    for (int i = 0; i < n; i++)
        if (rad_scene_named(c->scene, index, i, &mod, NULL) != 0)
            report(c, o, RAD_EDATA, "undefined modifier '%s'", o->strings[i]);
}

static void
check_reference(struct checker *c, const struct rad_object *o)
{
    check_names(c, o, o->nstrings ? 1 : 0);
}

static void
check_alias(struct checker *c, const struct rad_object *o)
{
    bool nothing = o->nstrings == 0 ? o->modifier == RAD_VOID
                                    : strcmp(o->strings[0], "void") == 0;

    /* if o has a line, the parser has reported this, with the name in
     * question */
    if (nothing && o->line == 0)
        report(c, o, RAD_EDATA, "alias of nothing");
    check_reference(c, o);
}

/* Each of the two mixed modifiers is defined before o, or "void". */
static void
check_mixture(struct checker *c, const struct rad_object *o)
{
    check_names(c, o, 2);
}

static void
check_scatter(struct checker *c, const struct rad_object *o)
{
    if (o->nreals % 3)
        report(c, o, RAD_EDATA, "expected 0, 3, 6 or 9 real arguments, got %d",
               (int)o->nreals);
}

static void
check_mixtext(struct checker *c, const struct rad_object *o)
{
    check_mixture(c, o);
    check_text(c, o);
}

/* The arguments of each type.  Strings that a type does not use are ignored, as
 * in Radiance. */
static const struct rule {
    enum rad_otype type;
    int min_strings, max_strings;
    int min_reals, max_reals;
    void (*check)(struct checker *c, const struct rad_object *o);
} rules[] = {
    /* clang-format off */
    { RAD_ALIAS,      0, 1,       0, INT_MAX,  check_alias },
    { RAD_SOURCE,     0, INT_MAX, 4, 4,        NULL },
    { RAD_SPHERE,     0, INT_MAX, 4, 4,        check_sphere },
    { RAD_BUBBLE,     0, INT_MAX, 4, 4,        check_sphere },
    { RAD_POLYGON,    0, INT_MAX, 9, INT_MAX,  check_polygon },
    { RAD_CONE,       0, INT_MAX, 8, 8,        check_cone },
    { RAD_CUP,        0, INT_MAX, 8, 8,        check_cone },
    { RAD_CYLINDER,   0, INT_MAX, 7, 7,        check_cone },
    { RAD_TUBE,       0, INT_MAX, 7, 7,        check_cone },
    { RAD_RING,       0, INT_MAX, 8, 8,        check_ring },
    { RAD_INSTANCE,   1, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_MESH,       1, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_LIGHT,      0, INT_MAX, 3, 3,        NULL },
    { RAD_ILLUM,      0, 1,       3, 3,        check_reference },
    { RAD_GLOW,       0, INT_MAX, 4, 4,        NULL },
    { RAD_SPOTLIGHT,  0, INT_MAX, 7, 7,        check_spotlight },
    { RAD_PLASTIC,    0, INT_MAX, 5, 5,        NULL },
    { RAD_METAL,      0, INT_MAX, 5, 5,        NULL },
    { RAD_TRANS,      0, INT_MAX, 7, 7,        NULL },
    { RAD_PLASTIC2,   4, INT_MAX, 6, 6,        check_rough },
    { RAD_METAL2,     4, INT_MAX, 6, 6,        check_rough },
    { RAD_TRANS2,     4, INT_MAX, 8, 8,        check_rough },
    { RAD_ASHIK2,     4, INT_MAX, 8, 8,        check_powers },
    { RAD_PLASFUNC,   2, INT_MAX, 4, INT_MAX,  NULL },
    { RAD_METFUNC,    2, INT_MAX, 4, INT_MAX,  NULL },
    { RAD_TRANSFUNC,  2, INT_MAX, 6, INT_MAX,  NULL },
    { RAD_PLASDATA,   4, INT_MAX, 4, INT_MAX,  NULL },
    { RAD_METDATA,    4, INT_MAX, 4, INT_MAX,  NULL },
    { RAD_TRANSDATA,  4, INT_MAX, 6, INT_MAX,  NULL },
    { RAD_BRTDFUNC,  10, INT_MAX, 9, INT_MAX,  NULL },
    { RAD_DIELECTRIC, 0, INT_MAX, 5, 5,        NULL },
    { RAD_INTERFACE,  0, INT_MAX, 8, 8,        check_interface },
    { RAD_GLASS,      0, INT_MAX, 3, 4,        check_glass },
    { RAD_MIRROR,     0, 1,       3, 3,        check_reference },
    { RAD_MIST,       0, INT_MAX, 0, 7,        NULL },
    { RAD_WGMDFUNC,  13, INT_MAX, 9, INT_MAX,  NULL },
    { RAD_PRISM1,     5, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_PRISM2,     9, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_ANTIMATTER, 1, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_COLORTEXT,  2, INT_MAX, 15, INT_MAX, check_text },
    { RAD_BRIGHTTEXT, 2, INT_MAX, 11, INT_MAX, check_text },
    { RAD_COLORFUNC,  4, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_BRIGHTFUNC, 2, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_TEXFUNC,    4, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_MIXFUNC,    4, INT_MAX, 0, INT_MAX,  check_mixture },
    { RAD_BSDF,       6, INT_MAX, 0, 9,        check_scatter },
    { RAD_ABSDF,      5, INT_MAX, 0, 9,        check_scatter },
    { RAD_BRIGHTDATA, 4, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_COLORDATA,  8, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_COLORPICT,  7, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_SPECTRUM,   0, 0,       5, INT_MAX,  check_range },
    { RAD_SPECFILE,   1, 1,       0, 0,        NULL },
    { RAD_SPECFUNC,   2, INT_MAX, 2, INT_MAX,  check_range },
    { RAD_SPECDATA,   4, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_SPECPICT,   5, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_TEXDATA,    8, INT_MAX, 0, INT_MAX,  NULL },
    { RAD_MIXDATA,    6, INT_MAX, 0, INT_MAX,  check_mixture },
    { RAD_MIXPICT,    7, INT_MAX, 0, INT_MAX,  check_mixture },
    { RAD_MIXTEXT,    4, INT_MAX, 9, INT_MAX,  check_mixtext },
    /* clang-format on */
};

/* The rule for a type; every type has one. */
static const struct rule *
find_rule(enum rad_otype type)
{
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++)
        if (rules[i].type == type)
            return &rules[i];
    return NULL;
}

static bool
check_count(struct checker *c, const struct rad_object *o, const char *kind,
            int n, int min, int max)
{
    if (n >= min && n <= max)
        return true;
    if (min == max)
        report(c, o, RAD_EDATA, "expected %d %s argument%s, got %d", min, kind,
               min == 1 ? "" : "s", n);
    else if (max == INT_MAX)
        report(c, o, RAD_EDATA, "expected at least %d %s arguments, got %d",
               min, kind, n);
    else
        report(c, o, RAD_EDATA, "expected %d to %d %s arguments, got %d", min,
               max, kind, n);
    return false;
}

static void
check_object(struct checker *c, const struct rad_object *o)
{
    const struct rule *r = find_rule(o->type);

    assert(r);
    if (check_count(c, o, "string", o->nstrings, r->min_strings,
                    r->max_strings) &&
        check_count(c, o, "real", o->nreals, r->min_reals, r->max_reals) &&
        r->check)
        r->check(c, o);
}

/* --- chains of modifiers ---------------------------------------------- */

/* For each object find the material in which its chain of modifiers ends; one
 * pass upwards is enough, as above.  stands_for[i] is the object that alias i
 * resolves to, or i. */
static void
find_materials(const struct rad_scene *s, int32_t *material,
               int32_t *stands_for)
{
    for (int32_t i = 0; i < s->nobjects; i++) {
        const struct rad_object *o = &s->objects[i];
        int32_t m = i;

        if (o->type == RAD_ALIAS) {
            m = o->nstrings ? rad_scene_find_modifier(s, o->strings[0], i)
                            : o->modifier;
            if (m != RAD_VOID)
                m = stands_for[m];
        }
        stands_for[i] = m;
        if (m == RAD_VOID ||
            rad_otype_class(s->objects[m].type) == RAD_CLASS_MATERIAL)
            material[i] = m;
        else
            material[i] =
                o->modifier == RAD_VOID ? RAD_VOID : material[o->modifier];
    }
}

/* The material of the chain of modifiers behind object o, without o itself. */
static const struct rad_object *
material_behind(const struct checker *c, const struct rad_object *o)
{
    int32_t m = o->modifier == RAD_VOID ? RAD_VOID : c->material[o->modifier];

    return m == RAD_VOID ? NULL : &c->scene->objects[m];
}

/* Refuse a material that is modified by another material. */
static void
check_material(struct checker *c, const struct rad_object *o)
{
    const struct rad_object *other = material_behind(c, o);

    if (other && rad_otype_class(o->type) == RAD_CLASS_MATERIAL)
        report(c, o, RAD_EDATA, "modified by another material, '%s'",
               other->name);
}

static bool
shines(const struct rad_object *m)
{
    switch (m->type) {
    case RAD_LIGHT:
    case RAD_ILLUM:
    case RAD_SPOTLIGHT:
    case RAD_GLOW:
        return m->nreals >= 3 &&
               (m->reals[0] > 0 || m->reals[1] > 0 || m->reals[2] > 0);
    default:
        return false;
    }
}

/* Is the material a source of direct light?  A glow of radius 0 is not. */
static bool
gives_light(const struct rad_object *m)
{
    return shines(m) &&
           (m->type != RAD_GLOW || m->nreals != 4 || m->reals[3] > 0);
}

/* Problems of a source that does not shine are warnings: it is left out. */
static void
check_source(struct checker *c, const struct rad_object *o,
             const struct rad_object *m)
{
    int code = m && shines(m) ? RAD_EDATA : RAD_WARNING;

    if (o->nreals != 4)
        return;
    if (zero_vector(o->reals))
        report(c, o, code, "zero direction");
    if (o->reals[3] <= 0)
        report(c, o, code, "angle %g is not above 0", o->reals[3]);
}

static void
check_surface(struct checker *c, const struct rad_object *o)
{
    const struct rad_object *m = material_behind(c, o);

    if (o - c->scene->objects >= rad_scene_own(c->scene))
        return; /* surfaces of parts are never light sources */
    switch (rad_object_shape(o)) {
    case RAD_SPHERE:
        /* other spheres of radius 0 are left out: genworm makes some */
        if (o->nreals == 4 && o->reals[3] == 0 && m && gives_light(m))
            report(c, o, RAD_EDATA, "a light source of zero radius");
        return;
    case RAD_SOURCE:
        check_source(c, o, m);
        return;
    case RAD_POLYGON:
    case RAD_CYLINDER:
    case RAD_RING:
    case RAD_INSTANCE: /* a material that it gives to its part is no source */
    case RAD_MESH:
        return;
    default:
        break;
    }
    if (m && gives_light(m))
        report(c, o, RAD_EDATA,
               "a %s cannot be a light source (its material is %s '%s')",
               rad_otype_name(o->type), rad_otype_name(m->type), m->name);
}

static void
check_reached(struct checker *c, const struct rad_object *o)
{
    /* report it once, where the nesting becomes too deep */
    if (c->depth[o - c->scene->objects] == RAD_MAX_NESTED + 1 &&
        (o->modifier == RAD_VOID || c->depth[o->modifier] <= RAD_MAX_NESTED))
        report(c, o, RAD_EDATA, "modifiers are nested more than %d deep",
               RAD_MAX_NESTED);
    if (rad_otype_is_surface(o->type))
        check_surface(c, o);
    else
        check_material(c, o);
}

/* --- the whole scene --------------------------------------------------- */

static void
check_all(struct checker *c)
{
    const struct rad_scene *s = c->scene;

    for (int32_t i = 0; i < s->nobjects && (c->each || !c->rc); i++)
        check_object(c, &s->objects[i]);
    for (int32_t i = 0; i < s->nobjects && (c->each || !c->rc); i++)
        if (c->reached[i])
            check_reached(c, &s->objects[i]);
}

int
rad_scene_check(const struct rad_scene *s,
                void (*each)(void *arg, const struct rad_error *err), void *arg,
                struct rad_error *err)
{
    struct checker c = { .scene = s, .each = each, .arg = arg, .err = err };
    size_t n = (size_t)s->nobjects + 1;
    int32_t *stands_for = malloc(n * sizeof *stands_for);

    c.reached = calloc(n, 1);
    c.material = malloc(n * sizeof *c.material);
    c.depth = malloc(n * sizeof *c.depth);
    if (stands_for && c.reached && c.material && c.depth) {
        rad_scene_reach(s, c.reached);
        rad_scene_nesting(s, c.depth);
        find_materials(s, c.material, stands_for);
        check_all(&c);
    } else {
        c.rc = rad_fail_memory(err);
    }
    free(stands_for);
    free(c.reached);
    free(c.material);
    free(c.depth);
    return c.rc;
}
