/* hemisphere.c - see hemisphere.h
 *
 * Samples are correlated multi-jittered: the ray of the cell in row i and
 * column j has an offset along x that belongs to row i, and an offset along y
 * that belongs to column j, each from a permutation of n finer steps.  So the
 * projections on both axes are stratified n^2 times, and no two neighbours
 * coincide, which would spoil the gradients.
 * Further rays (-as) go to cells where bright places of the frozen cache lie
 * (bright.h), and to cells whose neighbours differ (light/sample/contrast.h).
 * If the places are small, half of the further rays are drawn from a guide
 * (guide.h).
 * The rays of one cell follow a sequence that starts with the cell's first ray.
 * However many rays there are, they are spread evenly over the cell (Roberts
 * 2018: by the root of x^3 = x + 1).  */
#include "config.h"

#include "light/hemisphere/hemisphere.h"
#include "light/hemisphere/guide.h"
#include "arith/elementary.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/sample/contrast.h"
#include "light/sample/disk.h"

#include <string.h>

/* With fewer cells along a side than this, no further rays are shared out among
 * cells, whose differences say too little.  MIN_SIDE is more than the least
 * side of any record (rad_hemi_plan): else each of the many records that a
 * small -ad makes coarse would trace all of -as, which may be much more.  For
 * the same reason a guide has, with fewer cells, at most as many rays as there
 * are cells. */
#define MIN_SIDE 8
/* Reflectance assumed for the weight of rays that make a record: a record
 * serves surfaces of any reflectance. */
#define MEAN_REFLECTANCE .5f

/* The part of -as that is drawn from the guide, if there is one. */
#define GUIDED .5

/* A lamp that a hemisphere's rays see in gloss is a glint, which few rays meet
 * and each of these finds very bright: the sun in a rough rail made one record
 * in a thousand too bright by a hundred times, and with it all that it lights.
 * So where such rays meet gloss, its square roughness for lamps is larger by
 * this over the number of cells: a lobe of square roughness a fills about 4 a n
 * of n cells, here 4 at least.  The light is the same, spread over places that
 * a record cannot tell apart; see rad_gloss_widening() on grazing rays.
 * Source: Kaplanyan & Dachsbacher 2013, Path space regularization. */
#define CELL_ROUGHNESS 1.f

/* Added to the divisor in choose_side(), which -lw 0 makes 0. */
#define NO_WEIGHT 1e-20

/* The least distance of a hit, relative to plan->far; 1 / distance stays
 * finite. */
#define NEAREST 1e-12

/* Steps of the sequence (see above): the inverse of the root of x^3 = x + 1,
 * and the square of that inverse. */
#define STEP_X 0.7548776662466927
#define STEP_Y 0.5698402909980532

/* Dimensions of the random numbers that are drawn at the hemisphere's key. */
enum {
    DIM_TURN = 0,
    DIM_ROWS = 0x100000,
    DIM_COLUMNS = 0x200000,
    DIM_ROUND = 0x300000,
    DIM_JITTER = 0x400000,
    DIM_GUIDE = 0x800000
};

/* The rays of a cell, without those of the guide. */
struct tally {
    int rays;
    double lum;  /* mean luminance of these, each times part_of_cell() */
    double lum2; /* sum of the squares of these luminances */
    double x, y; /* where the first ray went through the cell, from 0 to 1 */
};

/* A hemisphere being sampled. */
struct sampler {
    struct rad_ctx *ctx;
    const struct rad_ray *r;
    const struct rad_hemi_plan *plan;
    struct rad_hemi *h;
    struct rad_rgb coef; /* coefficient of one ray, for its weight */
    float blur;          /* of the rays, 0: no record is made */
    enum rad_raykind kind;
    uint32_t branch;     /* added to the rays' branch numbers */
    uint64_t key;        /* of the hemisphere's own random numbers */
    int traced;          /* number of cells whose first ray was traced */
    struct tally *tally; /* of each cell */
    struct rad_guide guide;
    int guided; /* number of rays drawn from the guide; 0: there is no guide */
    double var; /* variance of the luminance that the guide's rays add to the
                 * cells' sum */
};

/* The distance of what a ray shows, seen through panes and in mirrors.  *wall
 * gets 1 / distance of the nearest surface it met, which may be a pane. */
static double
distance_met(const struct sampler *s, const struct rad_ray *ray, float *wall)
{
    double dist = rad_ray_distance(ray);

    dist = dist < s->plan->far ? dist : s->plan->far;
    dist = rad_most(dist, NEAREST * s->plan->far);
    *wall = (float)(1 / dist);
    if (ray->hit.obj != RAD_VOID && ray->hit.t < dist)
        *wall = (float)(1 / rad_most(ray->hit.t, NEAREST * s->plan->far));
    return dist;
}

/* Trace a ray through (x, y) of the square, which lies in cell c; false: the
 * ray was refused (-lw, -lr).  *L gets its radiance, d its direction in the
 * hemisphere's frame, *dist the distance of its hit. */
static bool
trace(struct sampler *s, struct rad_hemicell *c, double x, double y,
      uint32_t number, double d[3], struct rad_rgb *L, double *dist)
{
    struct rad_ctx *ctx = s->ctx;
    struct rad_ray ray;
    float near, wall;

    if (!rad_ray_spawn(ctx, &ray, s->kind, s->r, &s->coef, s->branch | number))
        return false;
    ray.blur = s->blur;
    rad_disk_of_square(x, y, d);
    d[2] = sqrt(rad_most(1 - d[0] * d[0] - d[1] * d[1], 0));
    rad_scale(ray.dir, d[0], s->h->u);
    rad_madd(ray.dir, ray.dir, d[1], s->h->v);
    rad_madd(ray.dir, ray.dir, d[2], s->h->w);
    ctx->counts.ambient_rays++;
    rad_ray_trace(ctx, &ray);
    /* roulette has raised the coefficient of a survivor */
    *L = rad_rgb_scale(ray.L, rad_rgb_max(ray.coef) / rad_rgb_max(s->coef));
    if (!s->plan->store) {
        *dist = 1;
        return true;
    }
    *dist = distance_met(s, &ray, &wall);
    near = (float)(1 / *dist);
    c->near = c->near > near ? c->near : near;
    c->wall = c->wall > wall ? c->wall : wall;
    return true;
}

/* A random permutation of 0..n-1, drawn at dimensions dim to dim + n - 1. */
static void
permute(uint64_t key, uint32_t dim, int n, int *perm)
{
    for (int i = 0; i < n; i++) {
        int k = (int)(rad_rand(key, dim + (uint32_t)i) * (i + 1));

        perm[i] = i;
        perm[i] = perm[k];
        perm[k] = i;
    }
}

/* Count a ray of the cell that found light L. */
static void
add_ray(struct sampler *s, uint32_t cell, struct rad_rgb L)
{
    double lum = rad_rgb_lum(L);

    s->tally[cell].rays++;
    s->tally[cell].lum2 += lum * lum;
}

/* May Russian roulette (-lr 0 or less) have let the hemisphere's rays die?
 * Each that died counts as black, for those that survive count for it. */
static bool
plays_roulette(const struct sampler *s)
{
    int deepest = s->ctx->job->params.maxdepth;

    return deepest == 0 || (deepest < 0 && s->r->level < -deepest);
}

/* Trace the first ray of each cell; false: none was traced, and the light is
 * not known. */
static bool
sample_cells(struct sampler *s)
{
    struct rad_hemi *h = s->h;
    int n = h->n;
    int *perm = rad_arena_alloc(&s->ctx->scratch, 2 * (size_t)n * sizeof *perm);

    if (!perm)
        return false;
    permute(s->key, DIM_ROWS, n, perm);
    permute(s->key, DIM_COLUMNS, n, perm + n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            uint32_t number = (uint32_t)(i * n + j);
            struct rad_hemicell *c = &h->cell[number];
            uint32_t dim = DIM_JITTER + 2 * number;
            double x = perm[i] + rad_rand(s->key, dim);
            double y = perm[n + j] + rad_rand(s->key, dim + 1);
            double d[3], dist;

            s->tally[number].x = x / n;
            s->tally[number].y = y / n;
            if (!trace(s, c, (j + x / n) / n, (i + y / n) / n, number, d, &c->L,
                       &dist))
                continue;
            rad_scale(c->p, dist, d);
            c->lum = rad_rgb_lum(c->L);
            s->tally[number].lum = (double)c->lum;
            add_ray(s, number, c->L);
            s->traced++;
        }
    return s->traced > 0 || plays_roulette(s);
}

static double
fraction(double x)
{
    return x - floor(x);
}

/* The part of the light at (x, y) of the square that counts for the cell's own
 * `rays` rays; the rest counts for the guide's rays. */
static double
part_of_cell(const struct sampler *s, int rays, double x, double y)
{
    if (s->guided == 0)
        return 1;
    double own = (double)rays * s->h->n * s->h->n;

    return own / (own + s->guided * rad_guide_density(&s->guide, x, y));
}

/* Trace `more` rays in cell (i, j) and make its mean anew.  *number is the
 * branch number of the next ray. */
static void
resample_cell(struct sampler *s, int i, int j, int more, uint32_t *number)
{
    int n = s->h->n;
    uint32_t cell = (uint32_t)(i * n + j);
    struct rad_hemicell *c = &s->h->cell[cell];
    struct tally *t = &s->tally[cell];
    struct rad_rgb sum = rad_rgb_scale(
        c->L, (float)part_of_cell(s, 1 + more, (j + t->x) / n, (i + t->y) / n));

    t->rays = 0;
    t->lum2 = 0;
    add_ray(s, cell, sum);
    for (int k = 0; k < more; k++, ++*number) {
        double x = (j + fraction(t->x + (k + 1) * STEP_X)) / n;
        double y = (i + fraction(t->y + (k + 1) * STEP_Y)) / n;
        double d[3], dist;
        struct rad_rgb L;

        if (!trace(s, c, x, y, *number, d, &L, &dist))
            continue;
        L = rad_rgb_scale(L, part_of_cell(s, 1 + more, x, y));
        sum = rad_rgb_add(sum, L);
        add_ray(s, cell, L);
    }
    c->L = rad_rgb_scale(sum, 1.f / (float)t->rays);
    t->lum = rad_rgb_lum(c->L);
}

/* Trace the rays of the guide, and add their part of the light to the cells. */
static void
follow_guide(struct sampler *s, uint32_t *number)
{
    struct rad_hemi *h = s->h;
    int n = h->n, side = s->guide.side, parts = side / n, lobe = 0;
    double sum = 0, sum2 = 0, count = s->guided;

    for (int k = 0; k < s->guided; k++, ++*number) {
        uint32_t dim = DIM_GUIDE + 5 * (uint32_t)k;
        double u[3] = { (k + rad_rand(s->key, dim)) / s->guided,
                        rad_rand(s->key, dim + 1), rad_rand(s->key, dim + 2) };
        int j, i;

        rad_guide_draw(&s->guide, u, &lobe, &j, &i);
        double x = (j + rad_rand(s->key, dim + 3)) / side;
        double y = (i + rad_rand(s->key, dim + 4)) / side;
        int cell = i / parts * n + j / parts;
        struct rad_hemicell *c = &h->cell[cell];
        double d[3], dist;
        struct rad_rgb L;

        if (!trace(s, c, x, y, *number, d, &L, &dist))
            continue;
        double all = (double)s->tally[cell].rays * n * n +
                     s->guided * rad_guide_density(&s->guide, x, y);
        L = rad_rgb_scale(L, n * n / all);
        c->L = rad_rgb_add(c->L, L);
        sum += (double)rad_rgb_lum(L);
        sum2 += (double)rad_rgb_lum(L) * (double)rad_rgb_lum(L);
    }
    s->var = s->guided > 1
                 ? rad_most(sum2 - sum * sum / count, 0) * count / (count - 1)
                 : sum2;
}

/* Are `more` rays enough to be shared out among the cells?  If no places are
 * known, differences of neighbours alone decide, and few rays would mostly go
 * to cells where they find nothing. */
static bool
worth_sharing(const struct sampler *s, int more)
{
    int n = s->h->n;

    return n >= MIN_SIDE && more >= (s->plan->bright ? 1 : 4) * n;
}

/* The cells and their shares of the further rays, in scratch; `bright` is as
 * rad_bright_look() sets it for all places.  NULL: out of memory. */
static struct rad_contrast *
set_shares(const struct sampler *s, const double *bright)
{
    const struct rad_hemi *h = s->h;
    int n = h->n;
    struct rad_contrast *c = rad_arena_calloc(
        &s->ctx->scratch, (size_t)rad_contrast_size(n), sizeof *c);

    if (!c)
        return NULL;
    for (int k = 0; k < n * n; k++) {
        const struct tally *t = &s->tally[k];

        c[rad_contrast_at(k, n)].lum =
            rad_rgb_lum(h->cell[k].L) *
            part_of_cell(s, 1, (k % n + t->x) / n, (k / n + t->y) / n);
    }
    if (s->plan->bright && s->guided == 0)
        rad_bright_cells(s->plan->bright, h, s->r->hit.p, bright, c);
    rad_contrast_share(c, n);
    return c;
}

/* Look at bright places: at all places if cells get rays for them, else at the
 * guide's places only.  Sets s->guided: how many of `count` rays are drawn from
 * the guide. */
static void
look_at_places(struct sampler *s, int count, bool all, double *share)
{
    const struct rad_bright *b = s->plan->bright;
    const double *p = s->r->hit.p;
    int n = s->h->n;

    rad_bright_look(b, all ? b->n : rad_guide_places(b), s->h, p, share);
    if (!rad_guide_set(&s->guide, b, s->h, p, share, s->plan->usual,
                       &s->ctx->scratch))
        return;
    s->guided = (int)(count * GUIDED + .5);
    if (n < MIN_SIDE && s->guided > n * n)
        s->guided = n * n;
}

/* Trace `count` further rays, of the guide, if there is one, and of cells. */
static void
super_sample(struct sampler *s, int count)
{
    int n = s->h->n;
    const struct rad_contrast *c = NULL;
    uint32_t number = (uint32_t)(n * n);
    bool shared = worth_sharing(s, count);
    double bright[RAD_BRIGHT_MOST];

    if (s->plan->bright && count > 0)
        look_at_places(s, count, shared, bright);
    if (shared)
        c = set_shares(s, bright);
    for (int k = 0; (c || s->guided > 0) && k < n * n; k++) {
        double share =
            c ? c[rad_contrast_at(k, n)].share * (count - s->guided) : 0;
        /* rounded up with a probability equal to the fraction */
        int more = (int)(share + rad_rand(s->key, DIM_ROUND + (uint32_t)k));

        if (more > 0 || s->guided > 0)
            resample_cell(s, k / n, k % n, more, &number);
    }
    if (s->guided > 0)
        follow_guide(s, &number);
}

/* The variance of a cell's mean luminance `lum`: by its own rays, or, if it has
 * one ray alone, by how its neighbours differ from it. */
static double
cell_variance(const struct sampler *s, int i, int j, double lum)
{
    static const int beside[4][2] = {
        { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 }
    };
    int n = s->h->n, k = i * n + j, rays = s->tally[k].rays, found = 0;
    double sum = 0;

    if (rays > 1)
        return rad_most(s->tally[k].lum2 / rays - lum * lum, 0) / (rays - 1);
    for (int b = 0; b < 4; b++) {
        int y = i + beside[b][0], x = j + beside[b][1];

        if (y < 0 || x < 0 || y >= n || x >= n)
            continue;
        double d = s->tally[y * n + x].lum - lum;
        int others = s->tally[y * n + x].rays;

        sum += d * d * others / (others + 1);
        found++;
    }
    return found > 0 ? sum / found : lum * lum;
}

/* The variance of E's luminance over its square.  Between cells of one ray each
 * all differences count as noise. */
static double
variance(const struct sampler *s)
{
    const struct rad_hemi *h = s->h;
    double sum = s->var, total = rad_rgb_lum(h->E) / M_PI * h->n * h->n;

    if (!(total > 0))
        return 0;
    for (int k = 0; k < h->n * h->n; k++)
        sum += cell_variance(s, k / h->n, k % h->n, s->tally[k].lum);
    return sum / (total * total);
}

/* A frame about the normal, turned by a random angle. */
static void
set_frame(struct sampler *s)
{
    struct rad_hemi *h = s->h;
    double a[3], b[3], sine, cosine;

    rad_sin_and_cos(2 * M_PI * rad_rand(s->key, DIM_TURN), &sine, &cosine);
    rad_copy(h->w, s->plan->normal);
    rad_frame(a, b, h->w);
    rad_scale(h->u, cosine, a);
    rad_madd(h->u, h->u, sine, b);
    rad_cross(h->v, h->w, h->u);
}

/* The number of cells along a side, by -ad and the plan's weight, which *weight
 * gets.  If no record is made, *weight is lowered until each ray has a weight
 * above -lw. */
static int
choose_side(const struct rad_params *par, const struct rad_ray *r,
            const struct rad_hemi_plan *plan, double *weight)
{
    *weight = plan->weight;
    if (!plan->store) {
        double most = .8 * rad_rgb_max(plan->coef) * r->weight /
                      (par->ambdiv * par->minweight + NO_WEIGHT);

        *weight = rad_least(*weight, most);
    }
    int n = (int)(sqrt(par->ambdiv * *weight) + .5);
    int least = plan->store ? plan->side : 1;

    return n > least ? n : least;
}

static void
set_coef(struct sampler *s)
{
    int n2 = s->h->n * s->h->n;

    s->coef = s->plan->store ? rad_grey(MEAN_REFLECTANCE)
                             : rad_rgb_scale(s->plan->coef, 1.f / (float)n2);
    s->blur = s->plan->store ? CELL_ROUGHNESS / (float)n2 : 0;
}

static bool
sample(struct rad_ctx *ctx, const struct rad_ray *r,
       const struct rad_hemi_plan *plan, struct rad_hemi *h)
{
    const struct rad_params *par = &ctx->job->params;
    struct sampler s = { .ctx = ctx, .r = r, .plan = plan, .h = h };
    struct rad_rgb sum = { 0, 0, 0 };
    double weight;
    int more, n2;

    if (!(rad_rgb_max(plan->coef) > 0))
        return false;
    h->n = choose_side(par, r, plan, &weight);
    n2 = h->n * h->n;
    h->cell = rad_arena_calloc(&ctx->scratch, (size_t)n2, sizeof *h->cell);
    s.tally = rad_arena_calloc(&ctx->scratch, (size_t)n2, sizeof *s.tally);
    if (!h->cell || !s.tally)
        return false;
    s.kind = plan->behind ? RAD_RAY_TAMBIENT : RAD_RAY_RAMBIENT;
    s.branch = plan->behind ? RAD_BRANCH_TAMBIENT : RAD_BRANCH_RAMBIENT;
    s.key = rad_key_branch(r->key, s.branch | 0xffffff); /* not of any ray */
    set_coef(&s);
    set_frame(&s);
    if (!sample_cells(&s))
        return false;
    h->complete = s.traced == n2;
    more = (int)(par->ambssamp * weight + .5);
    if (h->complete)
        super_sample(&s, more);
    for (int k = 0; k < n2; k++)
        sum = rad_rgb_add(sum, h->cell[k].L);
    h->E = rad_rgb_scale(sum, M_PI / n2);
    h->var = h->complete ? variance(&s) : -1;
    return true;
}

bool
rad_hemi_sample(struct rad_ctx *ctx, const struct rad_ray *r,
                const struct rad_hemi_plan *plan, struct rad_hemi *h)
{
    bool no_direct = ctx->no_direct, ok;

    ctx->no_direct = ctx->walk > 0;
    ok = sample(ctx, r, plan, h);
    ctx->no_direct = no_direct;
    return ok;
}
