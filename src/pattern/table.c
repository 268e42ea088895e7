/* table.c - see table.h */
#include "config.h"

#include "pattern/table.h"
#include "scene/file/data.h"
#include "pattern/effect.h"
#include "pattern/mixture.h"
#include "pattern/stored.h"

struct table {
    struct rad_effect effect; /* expressions: one for each dimension */
    const struct rad_pict *pict;
    const struct rad_data *data[3]; /* if there is no picture */
    int ndata;                      /* how many of them differ: 1 or 3 */
    bool together;                  /* coordinates: rad_expr_get_all() */
    int nfuncs;
    struct function {
        int call;
        int first; /* index of its first argument among the values */
    } func[3];
};

static bool
has_picture(enum rad_otype type)
{
    return type == RAD_COLORPICT || type == RAD_MIXPICT;
}

static bool
is_mixture(enum rad_otype type)
{
    return rad_otype_class(type) == RAD_CLASS_MIXTURE;
}

/* Find the data or the picture; returns the number of coordinates, or a
 * code. */
static int
read_tables(struct rad_job *job, const struct rad_object *o,
            const struct rad_files *files, const struct rad_file_strings *at,
            struct table *t, struct rad_error *err)
{
    if (has_picture(o->type)) {
        t->pict = rad_stored_picture(job, o, files, o->strings[at->first], err);
        return t->pict ? 2 : RAD_EDATA;
    }
    for (int i = 0; i < at->n; i++) {
        const char *name = o->strings[at->first + i];

        t->data[i] = rad_stored_data(job, o, files, name, err);
        if (!t->data[i])
            return RAD_EDATA;
        if (rad_data_dims(t->data[i]) != rad_data_dims(t->data[0]))
            return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                                  "'%s' has %d dimensions, '%s' has %d", name,
                                  rad_data_dims(t->data[i]),
                                  o->strings[at->first],
                                  rad_data_dims(t->data[0]));
        if (t->data[i] != t->data[0])
            t->ndata = at->n;
    }
    return rad_data_dims(t->data[0]);
}

/* Find the functions, whose names come before the tables', and in a mixture
 * after those of the two that it mixes.  Each gets all values of the place; but
 * a function for green or blue with fewer than three parameters gets its own
 * channel's alone. */
static int
find_functions(struct rad_job *job, const struct rad_object *o,
               const struct rad_file_strings *at, struct table *t,
               struct rad_error *err)
{
    int most = o->type == RAD_BRIGHTDATA || o->type == RAD_MIXDATA ? 1 : 3;
    int first = is_mixture(o->type) ? 2 : 0;

    t->nfuncs = at->first - first;
    for (int i = 0; i < t->nfuncs; i++) {
        int k = first + i, n = most;

        if (i > 0 && o->type != RAD_TEXDATA &&
            rad_calc_params(job->calc, t->effect.expr.context, o->strings[k],
                            NULL) < 3) {
            t->func[i].first = i;
            n = 1;
        }
        t->func[i].call = rad_expr_function(job, o, &t->effect.expr, k, n, err);
        if (t->func[i].call < 0)
            return t->func[i].call;
    }
    return 0;
}

/* The values at a place. */
static void
look_up(const struct table *t, const double place[], double found[3])
{
    if (t->pict) {
        rad_pict_value(t->pict, place[0], place[1], found);
        return;
    }
    rad_data_values(t->data, t->ndata, place, found);
    if (t->ndata == 1)
        found[1] = found[2] = found[0];
}

/* Apply the functions to the values at a place; false: a value is missing. */
static bool
values(struct rad_ctx *ctx, const struct rad_effect *e, const struct rad_ray *r,
       double value[3])
{
    const struct table *t = (const struct table *)e; /* e is its first member */
    double place[RAD_MAX_DATA_DIMS], found[3];
    enum rad_calc_fault fault = RAD_CALC_SOUND;
    struct rad_expr_scope scope;

    rad_expr_begin(ctx, &e->expr, r, &scope);
    if (!(t->together
              ? rad_expr_get_all(ctx, &e->expr, 0, e->expr.n, false, place)
              : rad_expr_get(ctx, &e->expr, 0, e->expr.n, place)))
        return false;
    look_up(t, place, found);
    for (int i = 0; i < t->nfuncs; i++)
        if (!rad_expr_call_next(ctx, t->func[i].call, found + t->func[i].first,
                                &fault, &value[i]))
            break;
    return rad_expr_sound(ctx, &e->expr, fault);
}

int
rad_table_prepare(struct rad_job *job, int32_t index,
                  const struct rad_files *files, const void **data,
                  struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    const struct rad_file_strings at = rad_otype_files(o->type);
    struct table *t = rad_arena_calloc(&job->arena, 1, sizeof *t);
    int place = at.function + 1, dims, rc;

    if (!t)
        return rad_fail_memory(err);
    if (o->nstrings <= at.function)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "too few string arguments");
    t->effect.values = values;
    t->together = has_picture(o->type) || o->type == RAD_TEXDATA;
    t->ndata = 1;
    dims = read_tables(job, o, files, &at, t, err);
    if (dims < 0)
        return dims;
    if (o->nstrings < place + dims)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "expected an expression for each of %d "
                              "dimensions",
                              dims);
    rc = rad_expr_prepare(job, o, files, ((1u << dims) - 1) << place,
                          &t->effect.expr, err);
    if (rc == 0)
        rc = find_functions(job, o, &at, t, err);
    if (rc == 0 && is_mixture(o->type))
        rc = rad_mixture_parts(job, index, t->effect.part, err);
    if (o->type == RAD_COLORDATA || o->type == RAD_COLORPICT)
        rad_effect_channels(job, &t->effect);
    *data = t;
    return rc;
}
