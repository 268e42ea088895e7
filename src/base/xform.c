/* xform.c - see xform.h
 *
 * Each word makes an elementary transform.  m is a rotation or reflection times
 * the scale, so its inverse is its transpose over the scale squared. */
#include "config.h"

#include "arith/elementary.h"
#include "base/xform.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct rad_xform identity = {
    .m = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
    .scale = 1,
};

void
rad_xform_identity(struct rad_xform *x)
{
    *x = identity;
}

bool
rad_xform_starts(const char *word)
{
    size_t n = strlen(word);

    if (n == 2)
        return word[0] == '-' && strchr("tsi", word[1]);
    return n == 3 && word[0] == '-' && strchr("rm", word[1]) &&
           strchr("xyz", word[2]);
}

/* Read the n numbers after words[0]. */
static int
read_numbers(const char *const *words, int left, int n, double *v,
             struct rad_error *err)
{
    if (left <= n)
        return rad_fail(err, RAD_EDATA, "transform '%s' lacks a number",
                        words[0]);
    for (int i = 0; i < n; i++) {
        char *end;

        v[i] = strtod(words[i + 1], &end);
        if (end == words[i + 1] || *end || !isfinite(v[i]))
            return rad_fail(err, RAD_EDATA, "bad number '%s' after '%s'",
                            words[i + 1], words[0]);
    }
    return 0;
}

static void
rotate(struct rad_xform *x, int axis, double deg)
{
    int j = (axis + 1) % 3, k = (axis + 2) % 3;
    double a = deg * (M_PI / 180);

    x->m[j][j] = x->m[k][k] = rad_cos(a);
    x->m[j][k] = rad_sin(a);
    x->m[k][j] = -rad_sin(a);
}

static void
resize(struct rad_xform *x, double factor)
{
    for (int i = 0; i < 3; i++)
        x->m[i][i] = factor;
    x->scale = fabs(factor);
}

/* Read one elementary transform; returns how many words it takes. */
static int
parse_one(struct rad_xform *x, const char *const *words, int left,
          struct rad_error *err)
{
    char kind = words[0][1];
    int n = kind == 't' ? 3 : kind == 'm' ? 0 : 1;
    double v[3];
    int rc = read_numbers(words, left, n, v, err);

    if (rc)
        return rc;
    *x = identity;
    switch (kind) {
    case 't':
        memcpy(x->t, v, sizeof v);
        break;
    case 'r':
        rotate(x, words[0][2] - 'x', v[0]);
        break;
    case 's':
        if (v[0] == 0)
            return rad_fail(err, RAD_EDATA, "transform scales by 0");
        resize(x, v[0]);
        break;
    default:
        x->m[words[0][2] - 'x'][words[0][2] - 'x'] = -1;
    }
    return n + 1;
}

/* Read the count after -i; with 0 or less the transforms after it are left
 * out. */
static int
read_count(const char *const *words, int left, int *count,
           struct rad_error *err)
{
    double v = 0;
    int rc = read_numbers(words, left, 1, &v, err);

    if (rc)
        return rc;
    if (v != floor(v) || v > RAD_MAX_XFORM_REPEAT)
        return rad_fail(err, RAD_EDATA, "bad count '%s' after '-i'", words[1]);
    *count = v > 0 ? (int)v : 0;
    return 2;
}

static void
repeat(struct rad_xform *x, const struct rad_xform *part, int count)
{
    while (count-- > 0)
        rad_xform_then(x, x, part);
}

static bool
is_sound(const struct rad_xform *x)
{
    double sum = x->scale;

    for (int i = 0; i < 3; i++)
        sum += fabs(x->t[i]) + fabs(x->m[i][0]) + fabs(x->m[i][1]) +
               fabs(x->m[i][2]);
    return isfinite(sum * sum) && x->scale * x->scale >= 0x1p-1022;
}

int
rad_xform_parse(struct rad_xform *x, const char *const *words, int n,
                struct rad_error *err)
{
    struct rad_xform part = identity, one;
    int count = 1;

    *x = identity;
    for (int i = 0, used; i < n; i += used) {
        if (!rad_xform_starts(words[i]))
            return rad_fail(err, RAD_EDATA, "'%s' is not a transform",
                            words[i]);
        if (words[i][1] == 'i') {
            repeat(x, &part, count);
            part = identity;
            used = read_count(words + i, n - i, &count, err);
        } else {
            used = parse_one(&one, words + i, n - i, err);
            if (used > 0)
                rad_xform_then(&part, &part, &one);
        }
        if (used < 0)
            return used;
    }
    repeat(x, &part, count);
    if (!is_sound(x))
        return rad_fail(err, RAD_EDATA, "transform is out of range");
    return 0;
}

void
rad_xform_vector(double out[3], const struct rad_xform *x, const double v[3])
{
    double r[3];

    for (int i = 0; i < 3; i++)
        r[i] = v[0] * x->m[0][i] + v[1] * x->m[1][i] + v[2] * x->m[2][i];
    memcpy(out, r, sizeof r);
}

void
rad_xform_point(double out[3], const struct rad_xform *x, const double p[3])
{
    rad_xform_vector(out, x, p);
    for (int i = 0; i < 3; i++)
        out[i] += x->t[i];
}

void
rad_xform_then(struct rad_xform *x, const struct rad_xform *a,
               const struct rad_xform *b)
{
    struct rad_xform r;

    for (int i = 0; i < 3; i++)
        rad_xform_vector(r.m[i], b, a->m[i]);
    rad_xform_point(r.t, b, a->t);
    r.scale = a->scale * b->scale;
    *x = r;
}

void
rad_xform_invert(struct rad_xform *x, const struct rad_xform *a)
{
    struct rad_xform r = identity;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.m[i][j] = a->m[j][i] / (a->scale * a->scale);
    r.scale = 1 / a->scale;
    rad_xform_vector(r.t, &r, a->t);
    for (int i = 0; i < 3; i++)
        r.t[i] = 0 - r.t[i]; /* 0, not -0: atan2() tells them apart */
    *x = r;
}
