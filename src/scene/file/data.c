/* data.c - see data.h
 *
 * Places and values are floats, as in Radiance, so that a place meant to be on
 * a grid line falls on the same side of it. */
#include "config.h"

#include "scene/file/data.h"
#include "base/color.h"
#include "base/number.h"
#include "base/text.h"
#include "image/hdr.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_WORD 63 /* bytes of a number */

struct axis {
    float org, len;  /* place of the first value, distance to the last */
    const float *at; /* places, NULL: at even steps */
    int32_t n;       /* at least 2; 1 only in pictures */
};

struct rad_data {
    int dims;
    struct axis axis[RAD_MAX_DATA_DIMS];
    float *value; /* the last dimension varies fastest */
};

struct rad_pict {
    struct axis x, y;
    uint8_t *rgbe; /* the top row first */
};

/* A coordinate between values i and i + 1, and the weights of these. */
struct place {
    int32_t i;
    double w[2];
};

/* --- reading ------------------------------------------------------------- */

struct reader {
    const char *p, *end;
    const char *sure; /* a word that begins before it ends in white space */
    int line;
    struct rad_error *err;
};

static int
bad(const struct reader *in, const char *what)
{
    return rad_fail(in->err, RAD_EDATA, "line %d: %s", in->line, what);
}

static void
skip_blanks(struct reader *in)
{
    while (in->p < in->end && (isspace((unsigned char)*in->p) || *in->p == '#'))
        if (*in->p == '#')
            while (in->p < in->end && *in->p != '\n')
                in->p++;
        else if (*in->p++ == '\n')
            in->line++;
}

static bool
ends_word(char c)
{
    return isspace((unsigned char)c) || c == '#';
}

static int
read_word(struct reader *in, char word[MAX_WORD + 1])
{
    size_t n = 0;

    skip_blanks(in);
    if (in->p == in->end)
        return bad(in, "data file ends early");
    while (in->p < in->end && !ends_word(*in->p))
        if (n < MAX_WORD)
            word[n++] = *in->p++;
        else
            return bad(in, "word too long");
    word[n] = '\0';
    return 0;
}

static int
read_real(struct reader *in, float *value)
{
    char word[MAX_WORD + 1];
    const char *p;
    double v;
    int rc;

    skip_blanks(in);
    p = in->p < in->sure ? rad_take_real(in->p, &v) : NULL;
    if (p && ends_word(*p)) {
        in->p = p;
    } else {
        if ((rc = read_word(in, word)))
            return rc;
        if (!rad_read_real(word, &v))
            return bad(in, "expected a number");
    }
    if (!(fabs(v) <= (double)FLT_MAX))
        return bad(in, "number out of range");
    *value = (float)v;
    return 0;
}

/* Read a count of at least `least`.  Each counted number takes two bytes of the
 * file, so a count too large for the file is refused before allocation. */
static int
read_count(struct reader *in, int32_t least, int32_t *n)
{
    char word[MAX_WORD + 1], *digits = word;
    int rc = read_word(in, word);
    long v;

    if (rc)
        return rc;
    digits += *digits == '+';
    if (!*digits || digits[strspn(digits, "0123456789")])
        return bad(in, "expected a whole number");
    v = strlen(digits) > 9 ? INT32_MAX : strtol(digits, NULL, 10);
    if (v < least)
        return bad(in, least == 1 ? "no dimensions" : "fewer than 2 points");
    if (v > (in->end - in->p) / 2 + 1)
        return bad(in, "fewer numbers than it says");
    *n = (int32_t)v;
    return 0;
}

/* Read places that all rise or all fall; equal ones count as falling. */
static int
read_places(struct reader *in, struct rad_arena *arena, struct axis *a)
{
    float *at = rad_arena_alloc(arena, (size_t)a->n * sizeof *at);
    int rc;

    if (!at)
        return rad_fail_memory(in->err);
    for (int32_t i = 0; i < a->n; i++) {
        if ((rc = read_real(in, &at[i])))
            return rc;
        if (i >= 2 && (at[i - 2] < at[i - 1]) != (at[i - 1] < at[i]))
            return bad(in, "places neither rise nor fall");
    }
    a->at = at;
    a->org = at[0];
    a->len = at[a->n - 1] - at[0];
    return 0;
}

static int
read_axis(struct reader *in, struct rad_arena *arena, struct axis *a)
{
    float end;
    int rc;

    if ((rc = read_real(in, &a->org)) || (rc = read_real(in, &end)) ||
        (rc = read_count(in, 2, &a->n)))
        return rc;
    a->len = end - a->org;
    if (a->len == 0)
        rc = read_places(in, arena, a);
    if (rc == 0 && !(fabsf(a->len) <= FLT_MAX))
        rc = bad(in, "places too far apart");
    return rc;
}

static int
read_values(struct reader *in, struct rad_arena *arena, struct rad_data *d)
{
    size_t n = 1, most = (size_t)(in->end - in->p) / 2 + 1;
    int rc = 0;

    for (int k = 0; k < d->dims; k++) {
        if ((size_t)d->axis[k].n > most / n)
            return bad(in, "fewer values than points");
        n *= (size_t)d->axis[k].n;
    }
    d->value = rad_arena_alloc(arena, n * sizeof *d->value);
    if (!d->value)
        return rad_fail_memory(in->err);
    for (size_t i = 0; i < n && rc == 0; i++)
        rc = read_real(in, &d->value[i]);
    return rc;
}

/* The place behind the last white space. */
static const char *
behind_blanks(const char *text, size_t len)
{
    while (len > 0 && !isspace((unsigned char)text[len - 1]))
        len--;
    return text + len;
}

struct rad_data *
rad_data_parse(struct rad_arena *arena, const char *text, size_t len,
               struct rad_error *err)
{
    struct reader in = { text + rad_text_mark(text, len), text + len,
                         behind_blanks(text, len), 1, err };
    struct rad_data *d = rad_arena_calloc(arena, 1, sizeof *d);
    int32_t dims;
    int rc;

    if (!d) {
        rad_fail_memory(err);
        return NULL;
    }
    rc = read_count(&in, 1, &dims);
    if (rc == 0 && dims > RAD_MAX_DATA_DIMS)
        rc = rad_fail(err, RAD_EDATA, "line %d: %d dimensions, at most %d",
                      in.line, (int)dims, RAD_MAX_DATA_DIMS);
    if (rc == 0)
        d->dims = (int)dims;
    for (int k = 0; k < d->dims && rc == 0; k++)
        rc = read_axis(&in, arena, &d->axis[k]);
    if (rc == 0)
        rc = read_values(&in, arena, d);
    return rc == 0 ? d : NULL;
}

int
rad_data_dims(const struct rad_data *d)
{
    return d->dims;
}

void
rad_data_axis(const struct rad_data *d, int dim, double *begin, double *length,
              int *n)
{
    const struct axis *a = &d->axis[dim];

    *begin = (double)a->org;
    *length = (double)a->len;
    *n = a->n;
}

struct rad_data *
rad_data_grid(struct rad_arena *arena, int dims, const int n[],
              const double length[], double begin, float **values)
{
    struct rad_data *d = rad_arena_calloc(arena, 1, sizeof *d);
    size_t all = 1;

    if (!d)
        return NULL;
    d->dims = dims;
    for (int k = 0; k < dims; k++) {
        d->axis[k].n = n[k];
        d->axis[k].len = (float)length[k];
        all *= (size_t)n[k];
    }
    d->axis[dims - 1].org = (float)begin;
    *values = d->value = rad_arena_alloc(arena, all * sizeof *d->value);
    return d->value ? d : NULL;
}

/* --- interpolation ------------------------------------------------------- */

/* The last i whose place is not beyond x; 0 if there is none. */
static int32_t
find_place(const struct axis *a, double x)
{
    int32_t lo = 0, hi = a->n;

    while (hi - lo > 1) {
        int32_t mid = lo + (hi - lo) / 2;

        if (a->len > 0 ? x >= (double)a->at[mid] : x < (double)a->at[mid])
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

/* Set the weights of values i and i + 1 at x, in steps from the first value.
 * Up to one step beyond the ends they continue the straight line; from there
 * they fall.  Beyond the last value the fall begins at a third of the weights,
 * as in Radiance's pictures. */
static void
weigh(struct place *at, double x)
{
    double beyond = x - at->i;

    if (beyond > 2) {
        at->w[0] = -1 / (1 + beyond);
        at->w[1] = -2 * at->w[0];
    } else if (beyond < -1) {
        at->w[1] = 1 / beyond;
        at->w[0] = -2 * at->w[1];
    } else {
        at->w[0] = 1 - beyond;
        at->w[1] = beyond;
    }
}

static struct place
locate(const struct axis *a, double x)
{
    struct place at = { 0, { 1, 0 } };
    int32_t last = a->n - 2;

    if (last < 0)
        return at; /* there is only one value */
    if (!a->at) {
        x = (x - (double)a->org) / (double)a->len * (a->n - 1);
        at.i = x >= last ? last : x > 0 ? (int32_t)x : 0;
    } else {
        at.i = find_place(a, x);
        if (at.i > last)
            at.i = last;
        x = at.i + (x - (double)a->at[at.i]) /
                       ((double)a->at[at.i + 1] - (double)a->at[at.i]);
    }
    weigh(&at, x);
    return at;
}

/* The corners of the cell about a place: the indices of their values, and the
 * weights of these.  Bit k of a corner's number is set for the upper value
 * along axis k. */
struct corners {
    size_t i[1 << RAD_MAX_DATA_DIMS];
    double w[1 << RAD_MAX_DATA_DIMS];
};

/* Go on from the corners of a cell of k dimensions to those with axis k.  Both
 * may be the same struct. */
static void
add_axis(const struct rad_data *d, int k, double x, const struct corners *from,
         struct corners *to)
{
    struct place place = locate(&d->axis[k], x);
    size_t n = (size_t)d->axis[k].n;

    for (int lower = 0; lower < 1 << k; lower++) {
        int upper = lower | 1 << k;

        to->i[lower] = from->i[lower] * n + (size_t)place.i;
        to->i[upper] = to->i[lower] + 1;
        to->w[upper] = from->w[lower] * place.w[1];
        to->w[lower] = from->w[lower] * place.w[0];
    }
}

static void
find_corners(const struct rad_data *d, int dims, const double at[],
             struct corners *c)
{
    c->i[0] = 0;
    c->w[0] = 1;
    for (int k = 0; k < dims; k++)
        add_axis(d, k, at[k], c, c);
}

/* With weight 0 a value does not count, even if it is infinite. */
static double
add_up(const struct rad_data *d, const struct corners *c)
{
    double sum = 0;

    for (int k = 0; k < 1 << d->dims; k++)
        if (c->w[k] != 0)
            sum += c->w[k] * (double)d->value[c->i[k]];
    return sum;
}

static bool
same_grid(const struct rad_data *a, const struct rad_data *b)
{
    return a->dims == b->dims &&
           memcmp(a->axis, b->axis, (size_t)a->dims * sizeof *a->axis) == 0;
}

void
rad_data_values(const struct rad_data *const d[], int n, const double at[],
                double value[])
{
    struct corners c;

    for (int k = 0; k < n; k++) {
        if (k == 0 || !same_grid(d[k], d[k - 1]))
            find_corners(d[k], d[k]->dims, at, &c);
        value[k] = add_up(d[k], &c);
    }
}

void
rad_data_row(const struct rad_data *d, const double at[], const double last[],
             int n, double value[])
{
    struct corners row, c;

    find_corners(d, d->dims - 1, at, &row);
    for (int i = 0; i < n; i++) {
        add_axis(d, d->dims - 1, last[i], &row, &c);
        value[i] = add_up(d, &c);
    }
}

double
rad_data_value(const struct rad_data *d, const double at[])
{
    double value;

    rad_data_values(&d, 1, at, &value);
    return value;
}

/* --- pictures ------------------------------------------------------------ */

struct rad_pict *
rad_pict_parse(struct rad_arena *arena, const struct rad_stream *in, bool kept,
               struct rad_error *err)
{
    struct rad_pict *p = rad_arena_calloc(arena, 1, sizeof *p);
    struct rad_coded_picture pic = { 0 };
    double w, h;

    if (!p) {
        rad_fail_memory(err);
        return NULL;
    }
    if (rad_hdr_stream_coded(in, RAD_MAX_DATA_PIXELS, kept, &pic, err) < 0)
        return NULL;
    w = pic.width;
    h = pic.height * pic.pixaspect;
    p->x.n = pic.width;
    p->y.n = pic.height;
    p->x.len = (float)(w <= h ? 1 : w / h);
    p->y.len = (float)(w <= h ? h / w : 1);
    if (!kept)
        return p;
    p->rgbe = rad_arena_adopt(arena, pic.rgbe,
                              4 * (size_t)pic.width * (size_t)pic.height);
    if (p->rgbe)
        return p;
    rad_fail_memory(err);
    return NULL;
}

void
rad_pict_value(const struct rad_pict *p, double x, double y, double rgb[3])
{
    struct place px = locate(&p->x, x), py = locate(&p->y, y);

    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int corner = 0; corner < 4; corner++) {
        int right = corner & 1, up = corner >> 1;
        double w = px.w[right] * py.w[up];
        struct rad_rgb L;
        size_t row;

        if (w == 0)
            continue;
        row = (size_t)(p->y.n - 1 - py.i - up);
        L = rad_rgbe_radiance(
            p->rgbe + 4 * (row * (size_t)p->x.n + (size_t)(px.i + right)));
        rgb[0] += w * (double)L.r;
        rgb[1] += w * (double)L.g;
        rgb[2] += w * (double)L.b;
    }
}
