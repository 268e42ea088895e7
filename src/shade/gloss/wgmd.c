/* wgmd.c - see wgmd.h
 *
 * r->n is not turned to the side that the ray comes from.  Only the normals
 * that modifiers tilt (struct view) are.  */
#include "config.h"

#include "shade/gloss/wgmd.h"
#include "arith/elementary.h"
#include "base/vec.h"
#include "light/indirect/ambient.h"
#include "light/direct/source.h"
#include "shade/gloss/aniso.h"
#include "pattern/expr.h"
#include "shade/gloss/gloss.h"

#include <stdlib.h>
#include <string.h>

/* From this reflectance on a mirror grows brighter toward grazing. */
#define FRESNEL_SPEC 0.017999

/* The parts of the light (normal.c), in the order in which their modifiers are
 * applied. */
enum part { RDIFF, TSPEC, TDIFF, RSPEC, NPARTS };

/* Index of the string that names a part's modifier; for specular parts three
 * expressions follow. */
static const int string_at[NPARTS] = { -1, 4, 8, 0 };

/* Stands for the material's own modifier. */
#define INHERIT (RAD_VOID - 1)

struct wgmd {
    struct rad_rgb front, back, through; /* diffuse parts */
    int32_t modifier[NPARTS];
    struct rad_expr expr; /* of rspec 0 to 2, of tspec 3 to 5, of u 6 to 8 */
};

/* A hit as one modifier has changed it. */
struct view {
    bool known; /* the other fields are set */
    int32_t modifier;
    double norm[3]; /* tilted by textures, on the ray's side */
    double cos_n;   /* -dir.norm */
    struct rad_rgb pattern;
    bool textured, bends; /* norm is tilted; it turns tspec (rad_ray_bends()) */
};

/* A hit on such a surface. */
struct wgmd_hit {
    struct rad_ctx *ctx;
    struct rad_ray *r;
    const struct wgmd *m;
    int32_t own; /* the material's modifier */
    struct view view[NPARTS];
    struct rad_rgb color[NPARTS];
    bool there[NPARTS];  /* specular parts: there is such a part */
    bool pure[NPARTS];   /* specular parts: there, and without roughness */
    bool follow[NPARTS]; /* strong enough to be sampled (-st) */
    struct rad_gloss gloss[NPARTS]; /* of rough specular parts */
    double along[3];                /* vector u */
    double ahead[3];                /* direction of tspec, or of its lobe */
    bool flat;                      /* flat, and rspec without texture */
    struct rad_expr_scope scope;
};

/* --- compiling ------------------------------------------------------------ */

/* Is a part 0 by its arguments, whatever its modifier? */
static bool
is_absent(const struct rad_object *o, enum part part)
{
    const char *text = o->strings[string_at[part] + 1];
    char *end;

    if (part == TDIFF)
        return o->reals[6] <= RAD_TINY && o->reals[7] <= RAD_TINY &&
               o->reals[8] <= RAD_TINY;
    return strtod(text, &end) <= RAD_TINY && end > text && *end == '\0';
}

/* Find the modifier that a part names.  If the part is 0 it need not exist. */
static int
find_modifier(struct rad_job *job, int32_t index, enum part part,
              int32_t *modifier, struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int32_t at = string_at[part];
    bool absent = is_absent(o, part);
    int rc;

    *modifier = INHERIT;
    if (strcmp(o->strings[at], "inherit") == 0)
        return 0;
    rc = rad_scene_named(job->scene, index, at, modifier, absent ? NULL : err);
    return absent ? 0 : rc;
}

int
rad_wgmd_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int code;
    struct wgmd *m =
        rad_material_begin(job, index, 9, INT32_MAX, sizeof *m, &code, err);

    if (!m)
        return code;
    *data = m;
    code = rad_expr_prepare(job, o, files, 0xeee, &m->expr, err);
    m->front = rad_job_colour(job, o->reals);
    m->back = rad_job_colour(job, o->reals + 3);
    m->through = rad_job_colour(job, o->reals + 6);
    m->modifier[RDIFF] = INHERIT;
    for (int part = TSPEC; code == 0 && part < NPARTS; part++)
        code = find_modifier(job, index, part, &m->modifier[part], err);
    return code;
}

/* --- the parts of a hit
 * ---------------------------------------------------- */

/* Set the view of a part: apply its modifier to the hit, unless that was done
 * for another part. */
static const struct view *
look(struct wgmd_hit *hit, enum part part)
{
    struct view *v = &hit->view[part];
    int32_t modifier = hit->m->modifier[part];
    struct rad_ray r;

    if (modifier == INHERIT)
        modifier = hit->own;
    for (int k = 0; k < NPARTS; k++)
        if (hit->view[k].known && hit->view[k].modifier == modifier) {
            *v = hit->view[k];
            return v;
        }
    r = *hit->r;
    rad_ray_texture(hit->ctx, &r, modifier);
    v->known = true;
    v->modifier = modifier;
    v->textured = rad_ray_perturbed(&r);
    v->bends = rad_ray_bends(hit->ctx, &r);
    v->pattern = r.pattern;
    v->cos_n = rad_ray_normal(&r, v->norm);
    if (r.cos_o < 0) {
        rad_scale(v->norm, -1, v->norm);
        v->cos_n = -v->cos_n;
    }
    return v;
}

/* Let the expressions see the hit as in view v.  (To be repeated for each part,
 * since modifiers may have evaluated other expressions.) */
static void
show(struct wgmd_hit *hit, const struct view *v)
{
    rad_expr_set_normal(hit->ctx, &hit->scope, v->norm, v->cos_n);
}

static bool
evaluate(const struct wgmd_hit *hit, int i, double *v)
{
    return rad_expr_get(hit->ctx, &hit->m->expr, i, 1, v);
}

/* Set the roughness of a specular part; false: it has no value. */
static bool
find_roughness(struct wgmd_hit *hit, enum part part)
{
    const struct view *v = &hit->view[part];
    struct rad_gloss *g = &hit->gloss[part];
    int first = part == RSPEC ? 0 : 3;

    g->av = 0;
    if (!evaluate(hit, first + 1, &g->au) ||
        (g->au > RAD_TINY && !evaluate(hit, first + 2, &g->av)))
        return false;
    hit->pure[part] = !(g->av > RAD_TINY);
    if (hit->pure[part])
        return true;
    g->ctx = hit->ctx;
    g->r = hit->r;
    rad_copy(g->norm, v->norm);
    if (!rad_aniso_frame(g->u, g->v, g->norm, hit->along))
        g->au = g->av = sqrt((g->au * g->au + g->av * g->av) / 2);
    return true;
}

static void
find_specular(struct wgmd_hit *hit, enum part part)
{
    const struct view *v;
    double coef;

    hit->color[part] = rad_grey(0);
    hit->there[part] = hit->pure[part] = false;
    v = look(hit, part);
    if (rad_rgb_max(v->pattern) <= RAD_TINY)
        return;
    show(hit, v);
    if (!evaluate(hit, part == RSPEC ? 0 : 3, &coef) || !(coef > RAD_TINY) ||
        !find_roughness(hit, part))
        return;
    hit->there[part] = true;
    hit->color[part] = rad_rgb_scale(v->pattern, coef);
}

static void
find_through(struct wgmd_hit *hit)
{
    hit->color[TDIFF] = rad_grey(0);
    if (rad_rgb_max(hit->m->through) > RAD_TINY)
        hit->color[TDIFF] =
            rad_rgb_mul(hit->m->through, look(hit, TDIFF)->pattern);
}

/* --- a mirror's gain toward grazing --------------------------------------- */

static bool
is_bright_mirror(const struct wgmd_hit *hit)
{
    return hit->there[RSPEC] && hit->pure[RSPEC] &&
           rad_rgb_lum(hit->color[RSPEC]) >= FRESNEL_SPEC;
}

/* As fresnel_rise() of normal.c, but .0009 at normal incidence, as in
 * Radiance. */
static double
fresnel_rise(double cos_i)
{
    return rad_exp(-5.85 * cos_i) - 0.00202943064;
}

static void
brighten_mirror(struct wgmd_hit *hit)
{
    float rise;

    if (!is_bright_mirror(hit))
        return;
    rise = (float)fresnel_rise(hit->view[RSPEC].cos_n);
    for (int part = 0; part < NPARTS; part++)
        hit->color[part] = rad_rgb_scale(hit->color[part], 1 - rise);
    hit->color[RSPEC] = rad_rgb_add(hit->color[RSPEC], rad_grey(rise));
}

/* --- light sources -------------------------------------------------------- */

static void
add_coef(struct rad_rgb *coef, struct rad_rgb color, double s)
{
    *coef = rad_rgb_add(*coef, rad_rgb_scale(color, s));
}

static void
add_diffuse(const struct wgmd_hit *hit, const double ldir[3], double omega,
            struct rad_rgb *coef)
{
    double f = omega / M_PI, cos_l;

    if (is_bright_mirror(hit)) /* whichever side the light is on */
        f *= 1 - fresnel_rise(fabs(rad_dot(hit->view[RSPEC].norm, ldir)));
    cos_l = rad_dot(hit->view[RDIFF].norm, ldir);
    if (cos_l > 0 && rad_rgb_max(hit->color[RDIFF]) > RAD_TINY)
        add_coef(coef, hit->color[RDIFF], cos_l * f);
    if (rad_rgb_max(hit->color[TDIFF]) > RAD_TINY) {
        cos_l = rad_dot(hit->view[TDIFF].norm, ldir);
        if (cos_l < 0)
            add_coef(coef, hit->color[TDIFF], -cos_l * f);
    }
}

static void
add_gloss(const struct wgmd_hit *hit, const double ldir[3], double omega,
          struct rad_rgb *coef)
{
    const struct rad_gloss *g = &hit->gloss[RSPEC];
    double spread = (1 - hit->ctx->job->params.srcjitter) * omega, cos_l, f;

    if (hit->there[RSPEC] && !hit->pure[RSPEC]) {
        cos_l = rad_dot(g->norm, ldir);
        f = cos_l > 0
                ? rad_gloss_brdf(g, ldir, hit->flat ? spread / (4 * M_PI) : 0)
                : 0;
        if (f > RAD_TINY)
            add_coef(coef, hit->color[RSPEC], f * cos_l * omega);
    }
    g = &hit->gloss[TSPEC];
    if (hit->there[TSPEC] && !hit->pure[TSPEC] && rad_dot(g->norm, ldir) < 0) {
        f = rad_gloss_btdf(g, hit->ahead,
                           rad_most(hit->view[TSPEC].cos_n, RAD_TINY), ldir,
                           omega);
        if (f > RAD_TINY)
            add_coef(coef, hit->color[TSPEC], f * omega);
    }
}

/* rad_brdf_fn */
static void
brdf(struct rad_rgb *coef, void *data, const double ldir[3], double omega)
{
    *coef = rad_grey(0);
    add_diffuse(data, ldir, omega, coef);
    add_gloss(data, ldir, omega, coef);
}

/* --- rays ----------------------------------------------------------------- */

/* Set hit->ahead: r's direction, turned by the tilt of tspec's normal, as long
 * as it still leads through the surface. */
static void
find_way_ahead(struct wgmd_hit *hit)
{
    const struct view *v = &hit->view[TSPEC];
    const struct rad_ray *r = hit->r;
    double side = r->cos_o < 0 ? -1 : 1;

    rad_copy(hit->ahead, r->dir);
    if (!hit->there[TSPEC] || !v->bends ||
        r->path & (RAD_RAY_SHADOW | RAD_RAY_AMBIENT))
        return;
    rad_madd(hit->ahead, r->dir, -side, v->norm);
    rad_madd(hit->ahead, hit->ahead, 1, r->n);
    if (!(side * rad_dot(hit->ahead, r->n) < 0) ||
        rad_normalize(hit->ahead) == 0)
        rad_copy(hit->ahead, r->dir);
}

static void
let_pass(struct wgmd_hit *hit)
{
    struct rad_rgb *color = hit->color;
    struct rad_ray *r = hit->r, tr;

    if (!rad_ray_spawn(hit->ctx, &tr, RAD_RAY_TRANS, r, &color[TSPEC],
                       RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, hit->ahead);
    rad_ray_trace(hit->ctx, &tr);
    r->L = rad_rgb_add(r->L, rad_rgb_mul(tr.L, tr.coef));
    if (color[TSPEC].r + color[TSPEC].g + color[TSPEC].b >= 3 * .999f) {
        r->L_mirror = rad_rgb_mul(tr.L_mirror, tr.coef);
        r->mirror_dist = r->hit.t + tr.mirror_dist;
        r->dist = r->hit.t + tr.dist;
    } else if (rad_rgb_lum(color[TSPEC]) >
               rad_rgb_lum(color[TDIFF]) + rad_rgb_lum(color[RDIFF])) {
        r->dist = r->hit.t + rad_ray_way_of(&tr);
    }
}

static void
mirror(struct wgmd_hit *hit)
{
    const struct view *v = &hit->view[RSPEC];
    struct rad_ray *r = hit->r, lr;

    if (!rad_ray_spawn(hit->ctx, &lr, RAD_RAY_REFLECTED, r, &hit->color[RSPEC],
                       RAD_BRANCH_REFLECT))
        return;
    rad_madd(lr.dir, r->dir, 2 * v->cos_n, v->norm);
    if (v->textured && rad_ray_through(r, lr.dir))
        rad_madd(lr.dir, r->dir, 2 * r->cos_o, r->n); /* not into the surface */
    rad_ray_mirror(hit->ctx, r, &lr, hit->flat && r->path & RAD_RAY_AMBIENT);
}

/* Add ambient light on one side, for the diffuse part, and for gloss that is
 * too weak to be sampled (-st). */
static void
add_ambient(struct wgmd_hit *hit, enum part diffuse, enum part gloss)
{
    struct rad_rgb coef = hit->color[diffuse];
    double norm[3];

    if (rad_rgb_max(coef) <= RAD_TINY)
        return;
    if (hit->there[gloss] && !hit->pure[gloss] && !hit->follow[gloss])
        coef = rad_rgb_add(coef, hit->color[gloss]);
    rad_scale(norm, diffuse == RDIFF ? 1 : -1, hit->view[diffuse].norm);
    rad_ambient_apply(hit->ctx, hit->r, norm, &coef);
    hit->r->L = rad_rgb_add(hit->r->L, coef);
}

static void
enter(struct wgmd_hit *hit, struct rad_ctx *ctx, const struct rad_material *mat,
      struct rad_ray *r)
{
    const struct view *v;

    hit->ctx = ctx;
    hit->r = r;
    hit->m = mat->data;
    hit->own = mat->next;
    for (int part = 0; part < NPARTS; part++)
        hit->view[part].known = false;
    v = look(hit, RDIFF);
    hit->color[RDIFF] =
        rad_rgb_mul(v->pattern, r->cos_o < 0 ? hit->m->back : hit->m->front);
    rad_expr_begin(ctx, &hit->m->expr, r, &hit->scope);
    show(hit, v);
    rad_aniso_get(ctx, &hit->m->expr, 6, r, hit->along);
}

/* Find the parts after RDIFF and TSPEC, which most shadow rays do not need. */
static void
find_rest(struct wgmd_hit *hit)
{
    double thresh = hit->ctx->job->params.specthresh + RAD_TINY;

    find_through(hit);
    find_specular(hit, RSPEC);
    hit->flat = !hit->view[RSPEC].textured && rad_ray_on_flat(hit->ctx, hit->r);
    brighten_mirror(hit);
    find_way_ahead(hit);
    for (int part = 0; part < NPARTS; part++)
        hit->follow[part] = rad_rgb_lum(hit->color[part]) > thresh;
}

bool
rad_wgmd_shade(struct rad_ctx *ctx, const struct rad_material *mat,
               struct rad_ray *r)
{
    struct wgmd_hit hit;

    if (r->cos_o < 0 && !ctx->job->params.backvis) {
        rad_ray_transmit(ctx, r);
        return true;
    }
    enter(&hit, ctx, mat, r);
    find_specular(&hit, TSPEC);
    if (r->path & RAD_RAY_SHADOW && !hit.pure[TSPEC])
        return true;
    find_rest(&hit);
    if (hit.there[TSPEC] && hit.pure[TSPEC])
        let_pass(&hit);
    if (r->path & RAD_RAY_SHADOW) /* the other parts cast a shadow */
        return true;
    if (hit.there[RSPEC] && hit.pure[RSPEC])
        mirror(&hit);
    else if (hit.there[RSPEC] && hit.follow[RSPEC])
        rad_gloss_reflect(&hit.gloss[RSPEC], &hit.color[RSPEC]);
    if (hit.there[TSPEC] && !hit.pure[TSPEC] && hit.follow[TSPEC])
        rad_gloss_transmit(&hit.gloss[TSPEC], hit.ahead, &hit.color[TSPEC]);
    add_ambient(&hit, RDIFF, RSPEC);
    add_ambient(&hit, TDIFF, TSPEC);
    rad_direct(ctx, r, brdf, &hit, true);
    return true;
}
