/* brdf.c - see brdf.h */
#include "config.h"

#include "shade/gloss/brdf.h"
#include "base/vec.h"
#include "light/indirect/ambient.h"
#include "light/direct/source.h"
#include "scene/file/data.h"
#include "pattern/expr.h"
#include "pattern/stored.h"

#include <string.h>

struct brdf {
    enum rad_otype type;
    struct rad_rgb color;
    double rdiff, rspec, trans, tdiff, tspec; /* parts of the light (normal.c);
                                               * trans is tdiff + tspec */
    struct rad_rgb front, back, through; /* BRTDfunc: diffuse reflectance of
                                          * both sides, diffuse transmittance */
    struct rad_expr expr;         /* BRTDfunc: colours of the mirrored and of
                                   * the transmitted light */
    int function[3];              /* of light, by channel; -1: none */
    bool shines;                  /* a channel has a function */
    const struct rad_data *data;  /* its value is the first argument; or NULL */
    int place[RAD_MAX_DATA_DIMS]; /* functions that give the place in data */
};

/* A hit on such a surface. */
struct brdf_hit {
    struct rad_ctx *ctx;
    struct rad_ray *r;
    const struct brdf *m;
    struct rad_rgb color;        /* with the patterns */
    struct rad_rgb rdiff, tdiff; /* diffuse reflectance and transmittance */
    double norm[3]; /* tilted by textures, on the side of the ray */
    double cos_n;   /* -dir.norm */
    struct rad_expr_scope scope;
};

/* --- compiling ------------------------------------------------------------ */

/* Compile the functions of light, which n strings name from `first` on: one for
 * all channels, or three, of which "0" means none. */
static int
compile_functions(struct rad_job *job, const struct rad_object *o, int first,
                  int n, struct brdf *m, struct rad_error *err)
{
    int nargs = m->data ? 5 : 4;

    for (int k = 0; k < 3; k++) {
        int string = first + job->primary[k] % n, same = 0;
        const char *name = o->strings[string];

        while (strcmp(o->strings[first + job->primary[same] % n], name) != 0)
            same++;
        if (n > 1 && strcmp(name, "0") == 0) {
            m->function[k] = -1;
            continue;
        }
        m->shines = true;
        m->function[k] =
            same < k ? m->function[same]
                     : rad_expr_function(job, o, &m->expr, string, nargs, err);
        if (m->function[k] < 0)
            return m->function[k];
    }
    return 0;
}

static int
prepare_brtd(struct rad_job *job, const struct rad_object *o,
             const struct rad_files *files, struct brdf *m,
             struct rad_error *err)
{
    int rc = rad_expr_prepare(job, o, files, 077, &m->expr, err);

    m->front = rad_job_colour(job, o->reals);
    m->back = rad_job_colour(job, o->reals + 3);
    m->through = rad_job_colour(job, o->reals + 6);
    m->color = rad_grey(1);
    m->rspec = m->tspec = 1;
    return rc ? rc : compile_functions(job, o, 6, 3, m, err);
}

/* Read the data file that the second string names, and compile a function for
 * each of its dimensions, which strings from the fourth on name. */
static int
prepare_data(struct rad_job *job, const struct rad_object *o,
             const struct rad_files *files, struct brdf *m,
             struct rad_error *err)
{
    int n;

    m->data = rad_stored_data(job, o, files, o->strings[1], err);
    if (!m->data)
        return RAD_EDATA;
    n = rad_data_dims(m->data);
    if (o->nstrings < 3 + n)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "'%s' has %d dimensions, which need as many "
                              "functions",
                              o->strings[1], n);
    for (int i = 0; i < n; i++) {
        m->place[i] = rad_expr_function(job, o, &m->expr, 3 + i, 4, err);
        if (m->place[i] < 0)
            return m->place[i];
    }
    return 0;
}

static bool
has_data(enum rad_otype type)
{
    return type == RAD_PLASDATA || type == RAD_METDATA || type == RAD_TRANSDATA;
}

static bool
is_trans(enum rad_otype type)
{
    return type == RAD_TRANSFUNC || type == RAD_TRANSDATA;
}

static int
prepare_simple(struct rad_job *job, const struct rad_object *o,
               const struct rad_files *files, struct brdf *m,
               struct rad_error *err)
{
    bool data = has_data(o->type);
    int rc = rad_expr_prepare(job, o, files, 0, &m->expr, err);

    m->color = rad_job_colour(job, o->reals);
    m->rspec = o->reals[3];
    if (is_trans(o->type)) {
        m->trans = o->reals[4] * (1 - m->rspec);
        m->tspec = m->trans * o->reals[5];
        m->tdiff = m->trans - m->tspec;
    }
    m->rdiff = 1 - m->trans - m->rspec;
    if (rc == 0 && data)
        rc = prepare_data(job, o, files, m, err);
    return rc ? rc : compile_functions(job, o, 0, 1, m, err);
}

int
rad_brdf_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int least = o->type == RAD_BRTDFUNC ? 9 : is_trans(o->type) ? 6 : 4;
    int code;
    struct brdf *m =
        rad_material_begin(job, index, least, INT32_MAX, sizeof *m, &code, err);

    if (!m)
        return code;
    m->type = o->type;
    *data = m;
    if (o->type == RAD_BRTDFUNC)
        return prepare_brtd(job, o, files, m, err);
    return prepare_simple(job, o, files, m, err);
}

/* --- light sources -------------------------------------------------------- */

/* Set arg[0] to the data's value at the place that functions of the other
 * arguments give; false: they have no value. */
static bool
look_up(struct brdf_hit *hit, double arg[5], enum rad_calc_fault *fault)
{
    double at[RAD_MAX_DATA_DIMS];

    for (int i = 0; i < rad_data_dims(hit->m->data); i++)
        if (!rad_expr_call_next(hit->ctx, hit->m->place[i], arg + 1, fault,
                                &at[i]))
            return false;
    arg[0] = rad_data_value(hit->m->data, at);
    return true;
}

/* Set *f to the functions' values for a light of solid angle omega at ldir;
 * false: they have none. */
static bool
scatter(struct brdf_hit *hit, const double ldir[3], double omega,
        struct rad_rgb *f)
{
    const struct brdf *m = hit->m;
    double arg[5], v[3];
    const double *args = m->data ? arg : arg + 1;
    enum rad_calc_fault fault = RAD_CALC_SOUND;

    rad_expr_resume(hit->ctx, &hit->scope);
    rad_expr_inward(&hit->scope, ldir, arg + 1);
    arg[4] = omega;
    if (m->data && !look_up(hit, arg, &fault))
        return rad_expr_sound(hit->ctx, &m->expr, fault);
    for (int k = 0; k < 3; k++) {
        int same = 0;

        while (m->function[same] != m->function[k])
            same++;
        if (m->function[k] < 0)
            v[k] = 0;
        else if (same < k)
            v[k] = v[same];
        else if (!rad_expr_call_next(hit->ctx, m->function[k], args, &fault,
                                     &v[k]))
            break;
    }
    if (!rad_expr_sound(hit->ctx, &m->expr, fault))
        return false;
    *f = rad_rgb((float)v[0], (float)v[1], (float)v[2]);
    return true;
}

/* rad_brdf_fn */
static void
brdf(struct rad_rgb *coef, void *data, const double ldir[3], double omega)
{
    struct brdf_hit *hit = data;
    const struct brdf *m = hit->m;
    double cos_l = rad_dot(hit->norm, ldir), part;
    bool metal = m->type == RAD_METFUNC || m->type == RAD_METDATA;
    bool tinted = cos_l > 0 ? metal : is_trans(m->type);
    struct rad_rgb f;

    *coef = rad_grey(0);
    if (fabs(cos_l) <= RAD_TINY)
        return;
    *coef = rad_rgb_scale(cos_l > 0 ? hit->rdiff : hit->tdiff,
                          fabs(cos_l) * omega / M_PI);
    part = cos_l > 0 ? m->rspec : m->tspec;
    if (part <= RAD_TINY || !scatter(hit, ldir, omega, &f) ||
        rad_rgb_lum(f) <= RAD_TINY)
        return;
    if (tinted)
        f = rad_rgb_mul(f, hit->color);
    f = rad_rgb_scale(f, part * fabs(cos_l) * omega);
    *coef = rad_rgb_add(*coef, f);
}

/* --- other light ---------------------------------------------------------- */

/* Add coef times the ambient light on one side. */
static void
add_ambient(struct brdf_hit *hit, bool behind, struct rad_rgb coef)
{
    double norm[3];

    rad_scale(norm, behind ? -1 : 1, hit->norm);
    rad_ambient_apply(hit->ctx, hit->r, norm, &coef);
    hit->r->L = rad_rgb_add(hit->r->L, coef);
}

static void
enter(struct brdf_hit *hit, struct rad_ctx *ctx, const struct brdf *m,
      struct rad_ray *r)
{
    hit->ctx = ctx;
    hit->r = r;
    hit->m = m;
    hit->color = rad_rgb_mul(m->color, r->pattern);
    hit->cos_n = rad_ray_normal(r, hit->norm);
    if (r->cos_o < 0) {
        rad_scale(hit->norm, -1, hit->norm);
        hit->cos_n = -hit->cos_n;
    }
    rad_expr_begin(ctx, &m->expr, r, &hit->scope);
    rad_expr_set_normal(ctx, &hit->scope, hit->norm, hit->cos_n);
    rad_expr_set_color(ctx, &hit->scope, hit->color);
}

bool
rad_brdf_shade(struct rad_ctx *ctx, const struct rad_material *mat,
               struct rad_ray *r)
{
    const struct brdf *m = mat->data;
    struct brdf_hit hit;

    if (r->path & RAD_RAY_SHADOW)
        return true;
    if (!rad_ray_face(ctx, r, mat->next))
        return true;
    enter(&hit, ctx, m, r);
    hit.rdiff = rad_rgb_scale(hit.color, m->rdiff);
    hit.tdiff = rad_rgb_scale(hit.color, m->tdiff);
    if (m->trans < 1 - RAD_TINY)
        add_ambient(&hit, false, rad_rgb_scale(hit.color, 1 - m->trans));
    if (m->trans > RAD_TINY)
        add_ambient(&hit, true, rad_rgb_scale(hit.color, m->trans));
    rad_direct(ctx, r, brdf, &hit, m->trans > RAD_TINY);
    return true;
}

/* Set *c to the colour of three expressions; false: they have no value. */
static bool
color_of(struct brdf_hit *hit, int first, struct rad_rgb *c)
{
    double v[3];

    rad_expr_resume(hit->ctx, &hit->scope);
    if (!rad_expr_get_all(hit->ctx, &hit->m->expr, first, 3, true, v))
        return false;
    *c = rad_job_colour(hit->ctx->job, v);
    return true;
}

/* Turn r's direction by the tilt of the normal.  (r->pert belongs to r->n,
 * which may be on either side.) */
static void
turn_ahead(const struct rad_ray *r, double dir[3])
{
    rad_madd(dir, r->dir, r->cos_o < 0 ? 1 : -1, r->pert);
    if (rad_normalize(dir) == 0)
        rad_copy(dir, r->dir);
}

static void
let_pass(struct brdf_hit *hit)
{
    struct rad_ray *r = hit->r, tr;
    bool straight =
        !rad_ray_perturbed(r) || r->path & (RAD_RAY_SHADOW | RAD_RAY_AMBIENT);
    struct rad_rgb coef;

    if (!color_of(hit, 3, &coef) ||
        !rad_ray_spawn(hit->ctx, &tr, RAD_RAY_TRANS, r, &coef,
                       RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, r->dir);
    if (!straight && rad_ray_bends(hit->ctx, r))
        turn_ahead(r, tr.dir);
    rad_ray_trace(hit->ctx, &tr);
    r->L = rad_rgb_add(r->L, rad_rgb_mul(tr.L, tr.coef));
    if (straight && rad_rgb_lum(hit->rdiff) + rad_rgb_lum(hit->tdiff) < 1)
        r->dist = r->hit.t + rad_ray_way_of(&tr);
}

static void
mirror(struct brdf_hit *hit)
{
    struct rad_ray *r = hit->r, lr;
    bool plain = !rad_ray_perturbed(r) || r->path & RAD_RAY_AMBIENT;
    struct rad_rgb coef;

    if (!color_of(hit, 0, &coef) ||
        !rad_ray_spawn(hit->ctx, &lr, RAD_RAY_REFLECTED, r, &coef,
                       RAD_BRANCH_REFLECT))
        return;
    rad_madd(lr.dir, r->dir, 2 * hit->cos_n, hit->norm);
    rad_ray_mirror(hit->ctx, r, &lr, plain && rad_ray_on_flat(hit->ctx, r));
}

bool
rad_brtd_shade(struct rad_ctx *ctx, const struct rad_material *mat,
               struct rad_ray *r)
{
    const struct brdf *m = mat->data;
    bool reflects, passes;
    struct brdf_hit hit;

    rad_ray_texture(ctx, r, mat->next);
    enter(&hit, ctx, m, r);
    hit.rdiff = rad_rgb_mul(hit.color, r->cos_o > 0 ? m->front : m->back);
    hit.tdiff = rad_rgb_mul(hit.color, m->through);
    reflects = rad_rgb_max(hit.rdiff) > RAD_TINY;
    passes = rad_rgb_max(hit.tdiff) > RAD_TINY;
    let_pass(&hit);
    if (r->path & RAD_RAY_SHADOW) /* the other parts cast a shadow */
        return true;
    mirror(&hit);
    if (reflects)
        add_ambient(&hit, false, hit.rdiff);
    if (passes)
        add_ambient(&hit, true, hit.tdiff);
    if (reflects || passes || m->shines)
        rad_direct(ctx, r, brdf, &hit, true);
    return true;
}
