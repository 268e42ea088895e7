/* quincunx.c - see quincunx.h
 *
 * The decisions are rpict's to the last bit, so the precision of each step is
 * rpict's: pixels are floats, but products with -pt and with interpolation
 * weights are taken in double.
 * Columns of a bar are bisected from the lower base line upwards, since rpict
 * counts rows from the bottom; the direction matters where a gap's halves have
 * different lengths. */
#include "config.h"

#include "picture/quincunx.h"

#include <float.h>
#include <math.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

void
rad_quincunx_steps(int psample, int *xstep, int *ystep)
{
    /* psample times sqrt(2) and over sqrt(2), rounded */
    *xstep = (140 * psample + 49) / 99;
    *ystep = (99 * psample + 70) / 140;
}

size_t
rad_quincunx_ndensity(const struct rad_quincunx *q)
{
    /* a density for each sample, for the halved gap, and for the end */
    return q->xstep > 2 ? (size_t)(q->width / q->xstep) + 3 : 0;
}

void
rad_quincunx_start(const struct rad_quincunx *q, uint8_t *density)
{
    memset(density, q->xstep, rad_quincunx_ndensity(q));
}

int
rad_quincunx_nbases(const struct rad_quincunx *q)
{
    return 1 + (q->height - 1 + q->ystep - 1) / q->ystep;
}

int
rad_quincunx_base_row(const struct rad_quincunx *q, int i)
{
    int y = i * q->ystep;

    return y < q->height ? y : q->height - 1;
}

static void
trace(const struct rad_quincunx *q, int x, int y, struct rad_pixel *out)
{
    q->trace(q->arg, q->x0 + x, q->y0 + y, out);
}

/* A pixel as a vector: its colour, then z. */
typedef float v4f __attribute__((vector_size(16)));
typedef int32_t v4i __attribute__((vector_size(16)));

static inline v4f
get(const struct rad_pixel *p)
{
    v4f v;

    memcpy(&v, p, sizeof v);
    return v;
}

/* One 16-byte store, as get() is one load: a load that spans several smaller
 * stores is slow. */
static inline void
put(struct rad_pixel *p, v4f v)
{
    memcpy(p, &v, sizeof v);
}

static bool
channel_differs(float a, float b, double maxdiff)
{
    return a - b > maxdiff * b || b - a > maxdiff * a;
}

static bool
exactly_differ(const struct rad_quincunx *q, v4f a, v4f b)
{
    if (q->depth && 2 * fabs(a[3] - b[3]) > q->maxdiff * (a[3] + b[3]))
        return true;
    return channel_differs(a[0], b[0], q->maxdiff) ||
           channel_differs(a[1], b[1], q->maxdiff) ||
           channel_differs(a[2], b[2], q->maxdiff);
}

static inline bool
are_all_three(v4i m)
{
#ifdef __SSE2__
    return (_mm_movemask_ps((__m128)m) & 7) == 7;
#else
    return m[0] & m[1] & m[2];
#endif
}

/* Do a and b differ by more than maxdiff?  Most pairs do not, by far, so a test
 * in float comes first; its limit is lower by more than its rounding, and pairs
 * that fail it get the exact test.  Equal channels do not differ.  NaN and
 * limits below FLT_MIN fail the float test, too. */
static inline bool
differ(const struct rad_quincunx *q, v4f a, v4f b)
{
    v4i more = a > b;
    v4f least = (v4f)((more & (v4i)b) | (~more & (v4i)a));
    v4f d = (v4f)((v4i)(a - b) & INT32_MAX);
    v4f limit = least * (float)(q->maxdiff * (1 - 0x1p-20));

    if (!q->depth &&
        are_all_three(((d <= limit) & (limit >= FLT_MIN)) | (d == 0)))
        return false;
    return exactly_differ(q, a, b);
}

/* Products in double, rounded to float. */
static inline v4f
weighted(v4f v, double w)
{
#ifdef __SSE2__
    __m128d lo = _mm_cvtps_pd(v), hi = _mm_cvtps_pd(_mm_movehl_ps(v, v));
    __m128d ww = _mm_set1_pd(w);

    return _mm_movelh_ps(_mm_cvtpd_ps(_mm_mul_pd(lo, ww)),
                         _mm_cvtpd_ps(_mm_mul_pd(hi, ww)));
#else
    return (v4f){ (float)(v[0] * w), (float)(v[1] * w), (float)(v[2] * w),
                  (float)(v[3] * w) };
#endif
}

/* The pixel at fraction wb of the way from a to b. */
static inline v4f
blend(const struct rad_quincunx *q, v4f a, v4f b, double wb)
{
    double wa = 1 - wb;
    v4f sum;

    if (wb == .5) /* in float a half is as exact as in double */
        sum = b * .5f + a * .5f;
    else
        sum = weighted(b, wb) + weighted(a, wa);
    if (q->depth)
        sum[3] = (float)((float)(b[3] * wb) + a[3] * wa);
    return sum;
}

/* (len / 2) / len by len, the position of a gap's middle pixel. */
static const double middle_of[RAD_QUINCUNX_MAX_XSTEP + 1] = {
    0,  0,       .5, 1. / 3,  .5, 2. / 5,   .5, 3. / 7,
    .5, 4. / 9,  .5, 5. / 11, .5, 6. / 13,  .5, 7. / 15,
    .5, 8. / 17, .5, 9. / 19, .5, 10. / 21, .5, 11. / 23
};

/* Two pixels are calm if they differ by so much less than the limit that
 * bisection between them finds no difference and traces nothing: all values
 * found lie between the two, but for rounding.
 * For a channel with ends a and b, 0 < a <= b <= (1 + c) a, values that are
 * computed between them in r roundings differ by at most c a + 2 r u b, with
 * u = 2^-24, and none is below a (1 - r u).  With c = 15/16 of the limit m,
 * that is at most m times the lesser value as long as 2 r u (1 + m)^2 < m / 16,
 * which the few roundings of one gap satisfy easily for m >= CALM_LEAST.
 * CALM_NORMAL keeps these values from denormal numbers; between two zeros all
 * values are 0. */
#define CALM_LEAST  1e-4
#define CALM_MOST   1.
#define CALM_FACTOR (15. / 16)
#define CALM_NORMAL 1e-30f /* far from where products lose digits */

/* The factor for are_calm(); negative: no pixels count as calm. */
static inline float
calm_limit(const struct rad_quincunx *q)
{
    if (q->depth || !(q->maxdiff >= CALM_LEAST && q->maxdiff <= CALM_MOST))
        return -1;
    return (float)(q->maxdiff * CALM_FACTOR);
}

/* Are a and b calm?  No, if the factor is not above 0. */
static inline bool
are_calm(v4f a, v4f b, float factor)
{
    v4i more = a > b;
    v4f least = (v4f)((more & (v4i)b) | (~more & (v4i)a));
    v4f d = (v4f)((v4i)(a - b) & INT32_MAX);
    v4f limit = least * factor;

    return factor > 0 && are_all_three(((d <= limit) & (limit >= CALM_NORMAL)) |
                                       ((a == 0) & (b == 0)));
}

/* The pixel halfway between a and b, as by blend(). */
static inline v4f
middle(v4f a, v4f b)
{
    return b * .5f + a * .5f;
}

static inline v4f
mix(v4f a, v4f b, double wb)
{
    return weighted(b, wb) + weighted(a, 1 - wb);
}

/* The pixels that fill_gap() puts into a calm gap of length 2, and 3. */
static inline void
mix_two(struct rad_pixel *p, v4f a, v4f b)
{
    put(&p[1], middle(a, b));
}

static inline void
mix_three(struct rad_pixel *p, v4f a, v4f b)
{
    v4f m = mix(a, b, 1. / 3);

    put(&p[1], m);
    put(&p[2], middle(m, b));
}

/* The pixels that fill_gap() puts into a calm gap of any length. */
static void
mix_gap(struct rad_pixel *p, int len)
{
    v4f a = get(&p[0]), b = get(&p[len]), m;
    int half = len / 2;

    switch (len) {
    case 1:
        return;
    case 2:
        mix_two(p, a, b);
        return;
    case 3:
        mix_three(p, a, b);
        return;
    case 5:
        m = mix(a, b, middle_of[5]);
        mix_two(p, a, m);
        put(&p[2], m);
        mix_three(p + 2, m, b);
        return;
    case 6:
        m = middle(a, b);
        mix_three(p, a, m);
        put(&p[3], m);
        mix_three(p + 3, m, b);
        return;
    default:
        m = middle_of[len] == .5 ? middle(a, b) : mix(a, b, middle_of[len]);
        put(&p[half], m);
        mix_gap(p, half);
        mix_gap(p + half, len - half);
    }
}

/* A gap in bisection: pixels p[0] to p[len], rightwards in a row or upwards in
 * a column, from (x, y). */
struct gap {
    const struct rad_quincunx *q;
    bool upwards;
};

/* Fill in pixels between p[0] and p[len], len at least 2; trace at least
 * `density` of them, evenly spread.  Returns the number traced. */
static int
fill_gap(const struct gap *g, struct rad_pixel *p, int x, int y, int len,
         int density)
{
    int found = 0;

    for (;;) {
        int half = len / 2;
        int xm = g->upwards ? x : x + half, ym = g->upwards ? y - half : y;

        v4f a = get(&p[0]), b = get(&p[len]);

        if (density > 0 || differ(g->q, a, b)) {
            trace(g->q, xm, ym, &p[half]);
            found++;
        } else {
            put(&p[half], blend(g->q, a, b, middle_of[len]));
        }
        if (half > 1)
            found += fill_gap(g, p, x, y, half, (density - 1) / 2);
        if (len - half < 2)
            return found;
        p += half;
        x = xm;
        y = ym;
        len -= half;
        density /= 2;
    }
}

/* fill_gap() with the short cut for calm ends. */
static int
fill_whole(const struct gap *g, struct rad_pixel *p, int x, int y, int len,
           int density)
{
    if (density > 0 || !are_calm(get(&p[0]), get(&p[len]), calm_limit(g->q)))
        return fill_gap(g, p, x, y, len, density);
    mix_gap(p, len);
    return 0;
}

/* Every other base line has its samples half a step to the left, so its first
 * gap is half as long. */
static bool
is_offset(const struct rad_quincunx_line *s)
{
    return s->i & 1;
}

/* Columns by which the first gap of base line i is shorter than xstep. */
static int
cut_off(const struct rad_quincunx *q, int i)
{
    return i & 1 && q->xstep > 1 ? q->xstep - q->xstep / 2 : 0;
}

void
rad_quincunx_guess(const struct rad_quincunx *q, uint8_t *density)
{
    size_t n = rad_quincunx_ndensity(q);
    size_t even = (size_t)rad_quincunx_ngaps(q, 0) + 1;
    size_t odd = (size_t)rad_quincunx_ngaps(q, 1);
    size_t reached = even > odd ? even : odd;

    memset(density, 0, n);
    if (reached < n)
        memset(density + reached, q->xstep, n - reached);
}

void
rad_quincunx_line_start(struct rad_quincunx_line *s,
                        const struct rad_quincunx *q, int i,
                        const uint8_t *above, uint8_t *below,
                        struct rad_pixel *pixels)
{
    memset(s, 0, sizeof *s);
    s->q = q;
    s->i = i;
    s->above = above;
    s->below = below;
    s->pixels = pixels;
    s->found = q->xstep;
    trace(q, 0, rad_quincunx_base_row(q, i), &pixels[0]);
}

size_t
rad_quincunx_line_needs(const struct rad_quincunx_line *s)
{
    return s->above ? s->gap + 2 : 0;
}

/* Densities beyond the line's gaps are copied from the line above. */
static void
finish_densities(struct rad_quincunx_line *s)
{
    size_t n = rad_quincunx_ndensity(s->q);

    if (!s->above)
        return;
    if (!is_offset(s))
        s->below[s->ndensity++] = (uint8_t)s->found;
    if (s->below != s->above)
        memcpy(s->below + s->ndensity, s->above + s->ndensity, n - s->ndensity);
    s->ndensity = n;
}

/* Gaps of a line without offset lie half a step right of the gaps of the line
 * below, so the count of a gap becomes density number gap + 1. */
static void
leave_density(struct rad_quincunx_line *s, int found)
{
    if (s->above)
        s->below[s->ndensity++] = (uint8_t)(is_offset(s) ? found : s->found);
}

/* The density that gap g takes over from the line above. */
static int
density_above(const uint8_t *above, size_t g)
{
    return above[g] > above[g + 1] ? above[g] : above[g + 1];
}

bool
rad_quincunx_line_step(struct rad_quincunx_line *s)
{
    const struct rad_quincunx *q = s->q;
    struct gap g = { q, false };
    int y = rad_quincunx_base_row(q, s->i);
    int density = s->found, found, len;

    if (s->x >= q->width - 1) {
        if (s->ndensity < rad_quincunx_ndensity(q))
            finish_densities(s);
        return false;
    }
    len = rad_quincunx_gap_begin(q, s->i, (int)s->gap + 1) - s->x;
    if (s->above)
        density = density_above(s->above, s->gap);
    trace(q, s->x + len, y, &s->pixels[s->x + len]);
    found = len > 1
                ? fill_whole(&g, s->pixels + s->x, s->x, y, len, density / 2)
                : 0;
    leave_density(s, found);
    s->found = found;
    s->gap++;
    s->x += len;
    if (s->x == q->width - 1)
        finish_densities(s);
    return true;
}

void
rad_quincunx_base(const struct rad_quincunx *q, int i, uint8_t *density,
                  struct rad_pixel *line)
{
    struct rad_quincunx_line s;

    if (rad_quincunx_ndensity(q) == 0)
        density = NULL;
    rad_quincunx_line_start(&s, q, i, density, density, line);
    while (rad_quincunx_line_step(&s))
        ;
}

int
rad_quincunx_ngaps(const struct rad_quincunx *q, int i)
{
    return (q->width - 1 + cut_off(q, i) + q->xstep - 1) / q->xstep;
}

int
rad_quincunx_gap_begin(const struct rad_quincunx *q, int i, int g)
{
    int x = g == 0 ? 0 : g * q->xstep - cut_off(q, i);

    return x < q->width - 1 ? x : q->width - 1;
}

void
rad_quincunx_gap(const struct rad_quincunx *q, int i, int g,
                 const uint8_t *above, struct rad_pixel *pixels)
{
    struct gap gap = { q, false };
    int y = rad_quincunx_base_row(q, i);
    int x = rad_quincunx_gap_begin(q, i, g);
    int len = rad_quincunx_gap_begin(q, i, g + 1) - x;
    int density = above ? density_above(above, (size_t)g) : 0;

    trace(q, x, y, &pixels[0]);
    trace(q, x + len, y, &pixels[len]);
    if (len > 1)
        fill_whole(&gap, pixels, x, y, len, density / 2);
}

/* Fill calm columns of a bar whose base lines are three rows apart, the most
 * common case, from column x up to the first that is not calm; returns that
 * column. */
static int
mix_columns(struct rad_pixel *const rows[], int x, int end, float factor)
{
    const struct rad_pixel *above = rows[0], *below = rows[3];
    struct rad_pixel *first = rows[1], *second = rows[2];

    if (!(factor > 0))
        return x;
    for (; x < end; x++) {
        v4f lower = get(&below[x]), upper = get(&above[x]), p;

        if (!are_calm(lower, upper, factor))
            break;
        p = mix(lower, upper, 1. / 3);
        put(&second[x], p);
        put(&first[x], middle(p, upper));
    }
    return x;
}

/* Fill columns as mix_columns() does, up to the first column in which
 * fill_gap() would trace a pixel; returns that column. */
static int
blend_columns(const struct rad_quincunx *q, struct rad_pixel *const rows[],
              int x, int end)
{
    const float factor = calm_limit(q);

    for (;; x++) {
        v4f lower, upper, p;

        x = mix_columns(rows, x, end, factor);
        if (x == end)
            return x;
        lower = get(&rows[3][x]);
        upper = get(&rows[0][x]);
        if (differ(q, lower, upper))
            return x;
        p = blend(q, lower, upper, 1. / 3);
        if (differ(q, p, upper))
            return x;
        put(&rows[2][x], p);
        put(&rows[1][x], blend(q, p, upper, .5));
    }
}

static void
fill_column(const struct gap *g, struct rad_pixel *const rows[], int n, int x,
            int y, int *found)
{
    struct rad_pixel column[RAD_QUINCUNX_MAX_YSTEP + 1];

    put(&column[0], get(&rows[n][x]));
    put(&column[n], get(&rows[0][x]));
    *found = fill_whole(g, column, x, y, n, *found / 2);
    for (int k = 1; k < n; k++)
        put(&rows[n - k][x], get(&column[k]));
}

void
rad_quincunx_bar_to(const struct rad_quincunx *q, int i,
                    struct rad_pixel *const rows[], struct rad_quincunx_fill *s,
                    int end)
{
    struct gap g = { q, true };
    int y = rad_quincunx_base_row(q, i + 1);
    int n = y - rad_quincunx_base_row(q, i);

    if (n < 2) {
        s->x = end;
        return;
    }
    if (s->x == 0)
        s->found = n;
    while (s->x < end) {
        if (n == 3 && s->found < 2) {
            int x = blend_columns(q, rows, s->x, end);

            if (x > s->x) {
                s->found = 0;
                s->x = x;
                continue;
            }
        }
        fill_column(&g, rows, n, s->x, y, &s->found);
        s->x++;
    }
}

void
rad_quincunx_bar_below(const struct rad_quincunx *q, int i,
                       struct rad_pixel *const rows[])
{
    struct rad_quincunx_fill s = { 0, 0 };

    rad_quincunx_bar_to(q, i, rows, &s, q->width);
}
