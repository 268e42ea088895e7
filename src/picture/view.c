/* view.c - see view.h
 *
 * Options are a table as in params.c.  The projections, where (a, b) is the
 * position from the picture's centre in widths and heights (shift and lift
 * added) and h, v, d are the unit vectors to the right, up and forward:
 *   'v'  d + a w h + b z v          w, z = 2 tan(angle / 2)
 *   'l'  d, from a w h + b z v      w, z as given
 *   'h'  a w h + b z v, the rest along d;      w, z = 2 sin(angle / 2)
 *   'a'  at angle pi |(a W, b Z)| from d,      W, Z = angle / 180
 *   'c'  turned by a W about v, + b z v        W = angle, z = 2 tan(vert / 2)
 *   's'  stereographic from (a w, b z)         w, z = 2 tan(angle / 4) */
#include "config.h"

#include "picture/view.h"
#include "arith/elementary.h"
#include "base/list.h"
#include "base/text.h"
#include "base/vec.h"
#include "base/number.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define DEGREE 0.017453292519943295769 /* [rad] */

struct option {
    const char *name;
    int nreals;
    size_t field; /* offset in struct rad_view */
    const char *help;
};

#define FIELD(f) offsetof(struct rad_view, f)

/* clang-format off */
static const struct option options[] = {
    { "-vp", 3, FIELD(vp), "view point" },
    { "-vd", 3, FIELD(vdir), "view direction" },
    { "-vu", 3, FIELD(vup), "view up" },
    { "-vh", 1, FIELD(horiz), "view horizontal size" },
    { "-vv", 1, FIELD(vert), "view vertical size" },
    { "-vo", 1, FIELD(vfore), "view fore clipping plane" },
    { "-va", 1, FIELD(vaft), "view aft clipping plane" },
    { "-vs", 1, FIELD(hoff), "view shift" },
    { "-vl", 1, FIELD(voff), "view lift" }
};

static const struct {
    char type;
    const char *name;
} types[] = {
    { 'v', "perspective" }, { 'l', "parallel" }, { 'h', "hemispherical" },
    { 'a', "angular" }, { 'c', "cylindrical" }, { 's', "planisphere" }
};

/* words that start a view line: Radiance's programs, and ours */
static const char *const makers[] = {
    "VIEW=", "rpict", "rvu", "rpiece", "rxpiece", "pinterp", "rview",
    "radsubmit"
};
/* clang-format on */

/* The longest word of a view line that can be an option or a value. */
enum { LONGEST_WORD = 64 };

void
rad_view_init(struct rad_view *v)
{
    memset(v, 0, sizeof *v);
    v->type = 'v';
    v->vdir[1] = 1;
    v->vup[2] = 1;
    v->horiz = v->vert = 45;
}

static const char *
type_name(char type)
{
    for (size_t i = 0; i < N_ELEM(types); i++)
        if (types[i].type == type)
            return types[i].name;
    return NULL;
}

static int
take_type(struct rad_view *v, const char *word, struct rad_error *err)
{
    if (!type_name(word[3]) || word[4] != '\0')
        return rad_fail(err, RAD_EUSAGE,
                        "option '%.40s': unknown view type, expected -vtv, "
                        "-vtl, -vth, -vta, -vtc or -vts",
                        word);
    v->type = word[3];
    return 1;
}

static int
take_reals(double *field, const struct option *o, int argc, char *const argv[],
           struct rad_error *err)
{
    double value[3];

    if (argc - 1 < o->nreals)
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': expected %d value%s, got %d", o->name,
                        o->nreals, o->nreals > 1 ? "s" : "", argc - 1);
    for (int i = 0; i < o->nreals; i++)
        if (!rad_parse_real(argv[i + 1], &value[i]))
            return rad_fail(err, RAD_EUSAGE,
                            "option '%s': expected a number, got '%.40s'",
                            o->name, argv[i + 1]);
    memcpy(field, value, (size_t)o->nreals * sizeof *field);
    return 1 + o->nreals;
}

int
rad_view_option(struct rad_view *v, int argc, char *const argv[],
                struct rad_error *err)
{
    if (argc < 1)
        return 0;
    if (strncmp(argv[0], "-vt", 3) == 0)
        return take_type(v, argv[0], err);
    for (size_t i = 0; i < N_ELEM(options); i++)
        if (strcmp(argv[0], options[i].name) == 0)
            return take_reals((double *)((char *)v + options[i].field),
                              &options[i], argc, argv, err);
    return 0;
}

/* Copy the next word of [*at, end); a word longer than LONGEST_WORD is cut, and
 * is neither an option nor a number then.  False: there is none. */
static bool
next_word(const char **at, const char *end, char word[LONGEST_WORD + 1])
{
    const char *s = *at;
    size_t n;

    while (s < end && isspace((unsigned char)*s))
        s++;
    if (s == end)
        return false;
    *at = s;
    while (*at < end && !isspace((unsigned char)**at))
        ++*at;
    n = (size_t)(*at - s);
    if (n > LONGEST_WORD)
        n = LONGEST_WORD;
    memcpy(word, s, n);
    word[n] = '\0';
    return true;
}

/* Does the line start with one of `makers`?  A path before a program's name is
 * skipped. */
static bool
is_view_line(const char *line, const char *end)
{
    const char *name = line;

    for (const char *s = line; s < end && !isspace((unsigned char)*s); s++)
        if (*s == '/')
            name = s + 1;
    for (size_t i = 0; i < N_ELEM(makers); i++) {
        size_t n = strlen(makers[i]);

        if ((size_t)(end - name) >= n && memcmp(name, makers[i], n) == 0)
            return true;
    }
    return false;
}

int
rad_view_line(struct rad_view *v, const char *line, size_t len,
              struct rad_error *err)
{
    const char *end = line + len, *at;
    char word[4][LONGEST_WORD + 1];
    char *argv[4] = { word[0], word[1], word[2], word[3] };
    int found = 0;

    line += rad_text_mark(line, len);
    if (!is_view_line(line, end))
        return 0;
    at = end - line >= 5 && memcmp(line, "VIEW=", 5) == 0 ? line + 5 : line;
    while (next_word(&at, end, word[0])) {
        const char *after = at;
        int argc = 1, used;

        while (argc < 4 && next_word(&after, end, word[argc]))
            argc++;
        used = rad_view_option(v, argc, argv, err);
        if (used < 0) {
            if (err)
                err->code = RAD_EDATA; /* wrong in a file, not in a command */
            return RAD_EDATA;
        }
        found |= used > 0;
        while (--used > 0)
            next_word(&at, end, word[0]);
    }
    return found;
}

int
rad_view_read(struct rad_view *v, const char *text, size_t len,
              struct rad_error *err)
{
    const char *end = text + len, *s = text;
    int nlines = 0;

    while (s < end && *s != '\n') {
        const char *stop = memchr(s, '\n', (size_t)(end - s));
        int rc;

        if (!stop)
            stop = end;
        rc = rad_view_line(v, s, (size_t)(stop - s), err);
        if (rc < 0)
            return rc;
        nlines += rc;
        s = stop < end ? stop + 1 : end;
    }
    return nlines;
}

/* Is the angle above 0 and below the largest, or equal to it if `reached`? */
static bool
angle_fits(double angle, double largest, bool reached)
{
    return angle > 0 && (reached ? angle <= largest : angle < largest);
}

static int
check_sizes(const struct rad_view *v, struct rad_error *err)
{
    bool h = v->horiz > 0, w = v->vert > 0;

    switch (v->type) {
    case 'v':
        h = angle_fits(v->horiz, 180, false);
        w = angle_fits(v->vert, 180, false);
        break;
    case 'c':
        h = angle_fits(v->horiz, 360, true);
        w = angle_fits(v->vert, 180, false);
        break;
    case 'a':
        h = angle_fits(v->horiz, 360, true);
        w = angle_fits(v->vert, 360, true);
        break;
    case 'h':
        h = angle_fits(v->horiz, 180, true);
        w = angle_fits(v->vert, 180, true);
        break;
    case 's':
        h = angle_fits(v->horiz, 360, false);
        w = angle_fits(v->vert, 360, false);
        break;
    }
    if (!h)
        return rad_fail(err, RAD_EUSAGE,
                        "illegal horizontal view size '-vh %g' for -vt%c",
                        v->horiz, v->type);
    if (!w)
        return rad_fail(err, RAD_EUSAGE,
                        "illegal vertical view size '-vv %g' for -vt%c",
                        v->vert, v->type);
    return 0;
}

/* Width or height of the view plane at distance 1 for a size of this type, in
 * degrees but for 'l'; see the table at the top. */
static double
extent(char rule, double size)
{
    switch (rule) {
    case 'v':
        return 2 * rad_tan(size * DEGREE / 2);
    case 'h':
        return 2 * rad_sin(size * DEGREE / 2);
    case 's':
        return 2 * rad_tan(size * DEGREE / 4);
    case 'l':
        return size;
    default: /* along the arc */
        return size * DEGREE;
    }
}

static int
set_axes(struct rad_view *v, struct rad_error *err)
{
    double up[3];

    rad_copy(v->dir, v->vdir);
    if (rad_normalize(v->dir) == 0)
        return rad_fail(err, RAD_EUSAGE, "zero view direction '-vd'");
    rad_copy(up, v->vup);
    if (rad_normalize(up) == 0)
        return rad_fail(err, RAD_EUSAGE, "zero view up vector '-vu'");
    rad_cross(v->hvec, v->dir, up);
    if (rad_normalize(v->hvec) == 0)
        return rad_fail(err, RAD_EUSAGE,
                        "view up '-vu' parallel to view direction '-vd'");
    rad_cross(v->vvec, v->hvec, v->dir);
    return 0;
}

int
rad_view_setup(struct rad_view *v, struct rad_error *err)
{
    double w, z;
    int rc;

    if (!type_name(v->type))
        return rad_fail(err, RAD_EUSAGE, "unknown view type");
    if (!(v->vfore >= 0) || !(v->vaft >= 0) ||
        (v->vaft > 0 && v->vaft <= v->vfore))
        return rad_fail(err, RAD_EUSAGE,
                        "illegal fore or aft clipping plane '-vo %g -va %g'",
                        v->vfore, v->vaft);
    if ((rc = check_sizes(v, err)) < 0 || (rc = set_axes(v, err)) < 0)
        return rc;
    w = extent(v->type, v->horiz);
    z = extent(v->type == 'c' ? 'v' : v->type, v->vert);
    v->hn2 = w * w;
    v->vn2 = z * z;
    if (v->type != 'a' && v->type != 's') {
        if (v->type != 'c')
            rad_scale(v->hvec, w, v->hvec);
        rad_scale(v->vvec, z, v->vvec);
    }
    return 0;
}

/* Round to the nearest integer, but to no more than `most`. */
static int
reduced(double size, int most)
{
    return size + .5 < most ? (int)(size + .5) : most;
}

void
rad_view_resolution(const struct rad_view *v, double *pixaspect, int *xres,
                    int *yres)
{
    double aspect = sqrt(v->vn2 / v->hn2); /* height over width */

    if (*pixaspect <= 0)
        *pixaspect = aspect * *xres / *yres;
    else if (aspect * *xres > *pixaspect * *yres)
        *xres = reduced(*yres / aspect * *pixaspect, *xres);
    else
        *yres = reduced(*xres * aspect / *pixaspect, *yres);
}

/* dir = forward*dir + x*hvec + y*vvec */
static void
combine(const struct rad_view *v, double forward, double x, double y,
        double dir[3])
{
    rad_scale(dir, forward, v->dir);
    rad_madd(dir, dir, x, v->hvec);
    rad_madd(dir, dir, y, v->vvec);
}

/* Angular fish-eye; false outside its circle. */
static bool
angular(const struct rad_view *v, double x, double y, double dir[3])
{
    double r, angle, s;

    x *= v->horiz / 180;
    y *= v->vert / 180;
    r = sqrt(x * x + y * y); /* angle / 180 degrees */
    if (r > 1)
        return false;
    angle = 180 * DEGREE * r;
    s = r > 0 ? rad_sin(angle) / r : 0;
    combine(v, rad_cos(angle), x * s, y * s, dir);
    return true;
}

/* The direction at (x, y) from the centre, of any length for 'v' and 'c', else
 * of length 1; false outside the projection. */
static bool
direction(const struct rad_view *v, double x, double y, double dir[3])
{
    double d;

    switch (v->type) {
    case 'v':
        combine(v, 1, x, y, dir);
        return true;
    case 'h':
        d = 1 - x * x * v->hn2 - y * y * v->vn2;
        if (d < 0)
            return false;
        combine(v, sqrt(d), x, y, dir);
        return true;
    case 'c':
        d = x * v->horiz * DEGREE;
        combine(v, rad_cos(d), rad_sin(d), y, dir);
        return true;
    case 'a':
        return angular(v, x, y, dir);
    case 's':
        x *= sqrt(v->hn2);
        y *= sqrt(v->vn2);
        d = x * x + y * y;
        combine(v, (1 - d) / (1 + d), 2 * x / (1 + d), 2 * y / (1 + d), dir);
        return true;
    default:
        rad_copy(dir, v->dir);
        return true;
    }
}

double
rad_view_ray(const struct rad_view *v, double x, double y, double org[3],
             double dir[3])
{
    double len;

    x += v->hoff - .5;
    y += v->voff - .5;
    if (!direction(v, x, y, dir))
        return -1;
    rad_madd(org, v->vp, v->vfore, dir);
    if (v->type == 'l') {
        rad_madd(org, org, x, v->hvec);
        rad_madd(org, org, y, v->vvec);
    }
    /* clipping is by planes for 'v' and by cylinders for 'c', so along the ray
     * distances grow off the axis */
    len = rad_normalize(dir);
    if (v->type != 'v' && v->type != 'c')
        len = 1;
    return v->vaft > 0 ? (v->vaft - v->vfore) * len : 0;
}

/* The point of the lens that u chooses, from the lens's centre. */
static void
lens_place(const struct rad_view *v, double diameter, const double u[3],
           bool thick, double p[3])
{
    double r = diameter / 2 * sqrt(u[0]), phi = 2 * M_PI * u[1];
    double right = r * rad_cos(phi) / sqrt(rad_dot(v->hvec, v->hvec));
    double up = r * rad_sin(phi) / sqrt(rad_dot(v->vvec, v->vvec));

    rad_scale(p, thick ? M_PI / 4 * diameter * (.5 - u[2]) : 0, v->dir);
    rad_madd(p, p, right, v->hvec);
    rad_madd(p, p, up, v->vvec);
}

double
rad_view_lens(const struct rad_view *v, double diameter, const double u[3],
              double org[3], double dir[3], double aft)
{
    bool flat = v->type == 'v' || v->type == 'l';
    double focus = sqrt(rad_dot(v->vdir, v->vdir)), place[3], centre[3], way[3];
    double fore;

    rad_copy(centre, v->vp);
    if (v->type == 'l')
        rad_madd(centre, org, -v->vfore, dir);
    fore = sqrt(rad_dist2(org, centre));
    if (flat)
        focus /= rad_dot(dir, v->dir);
    lens_place(v, diameter, u, !flat, place);
    rad_scale(way, focus, dir);
    rad_sub(way, way, place);
    if (rad_normalize(way) == 0)
        return aft; /* the lens point is the focus itself */
    if (flat) {     /* the clipping planes stay where they are */
        double cosine = rad_dot(way, v->dir);

        if (!(cosine > 0))
            return aft;
        fore = v->vfore / cosine;
        aft = v->vaft > 0 ? (v->vaft - v->vfore) / cosine : 0;
    }
    rad_copy(dir, way);
    rad_madd(org, centre, 1, place);
    rad_madd(org, org, fore, dir);
    return aft;
}

/* Which clipping planes exclude a point at this distance? */
static unsigned
clipped(const struct rad_view *v, double dist)
{
    unsigned bits = 0;

    if (dist <= v->vfore)
        bits |= RAD_VIEW_BEHIND;
    if (v->vaft > 0 && dist >= v->vaft)
        bits |= RAD_VIEW_BEYOND;
    return bits;
}

/* Position of unit direction d in a fish-eye that is not hemispherical. */
static unsigned
locate_fisheye(const struct rad_view *v, const double d[3], double pos[2])
{
    double right = rad_dot(d, v->hvec), up = rad_dot(d, v->vvec);
    double forward = rad_dot(d, v->dir);
    double s = sqrt(right * right + up * up); /* sine of the angle to dir */

    if (v->type == 'a') {
        double angle = rad_atan2(s, forward) / DEGREE;
        double scale = s > 0 ? angle / s : 0;

        pos[0] = right * scale / v->horiz;
        pos[1] = up * scale / v->vert;
        if (s == 0 && forward < 0)
            return RAD_VIEW_NOWHERE; /* backward is all of the circle's edge */
        return 0;
    }
    if (1 + forward <= 0)
        return RAD_VIEW_NOWHERE;
    pos[0] = right / ((1 + forward) * sqrt(v->hn2));
    pos[1] = up / ((1 + forward) * sqrt(v->vn2));
    return 0;
}

/* Perspective, parallel and hemispherical.  disp is the point from the view
 * point; it is scaled to the view plane. */
static unsigned
locate_flat(const struct rad_view *v, double disp[3], double pos[2])
{
    double forward = rad_dot(disp, v->dir);
    double dist = forward;

    if (v->type == 'v') {
        if (forward == 0)
            return RAD_VIEW_NOWHERE;
        rad_scale(disp, 1 / fabs(forward), disp);
    } else if (v->type == 'h') {
        dist = copysign(rad_normalize(disp), forward);
    }
    pos[0] = rad_dot(disp, v->hvec) / v->hn2;
    pos[1] = rad_dot(disp, v->vvec) / v->vn2;
    return clipped(v, dist);
}

static unsigned
locate_cylinder(const struct rad_view *v, const double disp[3], double pos[2])
{
    double right = rad_dot(disp, v->hvec), forward = rad_dot(disp, v->dir);
    double dist = sqrt(right * right + forward * forward);

    if (dist == 0)
        return RAD_VIEW_NOWHERE;
    pos[0] = rad_atan2(right, forward) / (v->horiz * DEGREE);
    pos[1] = rad_dot(disp, v->vvec) / (dist * v->vn2);
    return clipped(v, dist);
}

unsigned
rad_view_locate(const struct rad_view *v, const double p[3], double pos[2])
{
    double disp[3], off[2] = { 0, 0 };
    unsigned bits;

    rad_sub(disp, p, v->vp);
    if (v->type == 'a' || v->type == 's') {
        bits = clipped(v, rad_normalize(disp));
        bits |= locate_fisheye(v, disp, off);
    } else if (v->type == 'c') {
        bits = locate_cylinder(v, disp, off);
    } else {
        bits = locate_flat(v, disp, off);
    }
    pos[0] = off[0] + .5 - v->hoff;
    pos[1] = off[1] + .5 - v->voff;
    if (!(pos[0] > 0 && pos[0] < 1 && pos[1] > 0 && pos[1] < 1))
        bits |= RAD_VIEW_OUTSIDE;
    return bits;
}

static void
format_option(const struct rad_view *v, const struct option *o, char *buf,
              size_t size)
{
    const double *field = (const double *)((const char *)v + o->field);
    size_t used = (size_t)snprintf(buf, size, "%s", o->name);

    for (int i = 0; i < o->nreals; i++) {
        char num[RAD_NUMBER_TEXT];

        rad_format_real(num, field[i]);
        used += (size_t)snprintf(buf + used, size - used, " %s", num);
    }
}

void
rad_view_format(const struct rad_view *v, char *buf, size_t size)
{
    char text[128];
    size_t used = (size_t)snprintf(buf, size, "-vt%c", v->type);

    for (size_t i = 0; i < N_ELEM(options) && used < size; i++) {
        format_option(v, &options[i], text, sizeof text);
        used += (size_t)snprintf(buf + used, size - used, " %s", text);
    }
}

void
rad_view_print_defaults(const struct rad_view *v,
                        void (*line)(void *arg, const char *text), void *arg)
{
    const char *name = type_name(v->type);
    char text[128], full[192];

    snprintf(text, sizeof text, "-vt%c", v->type);
    snprintf(full, sizeof full, "%-31s # view type: %s", text,
             name ? name : "unknown");
    line(arg, full);
    for (size_t i = 0; i < N_ELEM(options); i++) {
        format_option(v, &options[i], text, sizeof text);
        snprintf(full, sizeof full, "%-31s # %s", text, options[i].help);
        line(arg, full);
    }
}
