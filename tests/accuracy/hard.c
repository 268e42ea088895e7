/* hard.c - see hard.h
 *
 * Leaks: rays from within a closed mesh at its edges and vertices, of which
 * none may get out.
 * Scale and offset: the same room in other units, or elsewhere, looks the same.
 * Elsewhere its coordinates are rounded, so it is compared with the room at
 * the origin whose coordinates are rounded as they are there.
 * Acne: a ball of the size of a planet that shades itself nowhere.
 * The rest is one scene each, and says what it counts. */
#include "config.h"

#include "hard.h"
#include "stage.h"
#include "base/vec.h"
#include "picture/frame.h"
#include "tests/blocked.h"
#include "tests/closed_mesh.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Text that grows. */
struct text {
    char *at;
    size_t len, room;
};

__attribute__((format(printf, 2, 3))) static void
add(struct text *t, const char *format, ...)
{
    va_list ap;
    int n;

    va_start(ap, format);
    n = vsnprintf(NULL, 0, format, ap);
    va_end(ap);
    if (t->room - t->len <= (size_t)n) {
        t->room = 2 * t->room + (size_t)n + 1;
        t->at = realloc(t->at, t->room);
        if (!t->at)
            exit(EXIT_FAILURE);
    }
    va_start(ap, format);
    vsnprintf(t->at + t->len, (size_t)n + 1, format, ap);
    va_end(ap);
    t->len += (size_t)n;
}

/* --- leaks --- */

/* Rays that leave a closed mesh of size a[0] at a[1]. */
static double
leaks(struct stage *s, const double *a)
{
    const double c[3] = { a[1], a[1], -a[1] };
    struct rad_geom_counts counts = { 0 };
    struct text t = { NULL, 0, 0 };
    int out = 0;

    add(&t, "void plastic p 0 0 5 .5 .5 .5 0 0\n");
    for (int v = 0; v < MESH_NV; v++)
        for (int u = 0; u < MESH_NU; u++) {
            double face[2][12];
            int corners[2], n = mesh_faces(u, v, a[0], c, face, corners);

            for (int k = 0; k < n; k++) {
                add(&t, "p polygon f 0 0 %d", 3 * corners[k]);
                for (int i = 0; i < 3 * corners[k]; i++)
                    add(&t, " %.17g", face[k][i]);
                add(&t, "\n");
            }
        }
    stage_open(s, "", "%s", t.at);
    for (int i = 0; i < 50000 * s->effort; i++) {
        struct rad_span span = { .tmin = 0, .tmax = INFINITY };
        struct rad_hit hit;

        mesh_ray(rad_key_branch(8, (uint64_t)i), a[0], c, span.org, span.dir);
        out += !rad_geom_nearest(s->job->geom, &span, &hit, &counts);
        out += !is_blocked(s->job->geom, &span, RAD_VOID, NULL, &counts);
    }
    free(t.at);
    return out;
}

/* --- the room --- */

/* How a room is changed: its coordinates scaled, moved, and moved back. */
struct place {
    double scale, offset;
    bool back;
    bool dark; /* its lamps are out */
};

static double
at(const struct place *p, double x)
{
    volatile double there = x * p->scale + p->offset; /* rounded as stored */

    return p->back ? there - p->offset : there;
}

static void
add_point(struct text *t, const struct place *p, double x, double y, double z)
{
    add(t, " %.17g %.17g %.17g", at(p, x), at(p, y), at(p, z));
}

static void
add_box(struct text *t, const struct place *p, const char *modifier,
        const double lo[3], const double hi[3])
{
    /* corners of each face, outward: bit k of a corner is its side in k */
    static const int face[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 },
                                    { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
                                    { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };

    for (int f = 0; f < 6; f++) {
        add(t, "%s polygon f 0 0 12", modifier);
        for (int i = 0; i < 4; i++) {
            int c = face[f][i];

            add_point(t, p, c & 1 ? hi[0] : lo[0], c & 2 ? hi[1] : lo[1],
                      c & 4 ? hi[2] : lo[2]);
        }
        add(t, "\n");
    }
}

/* Walls, a desk on legs, drawers that touch it, a glass top, a pot, a globe, a
 * lamp flush with the ceiling, a tube, and the sun through a window. */
static void
add_room(struct text *t, const struct place *p)
{
    static const double box[][6] = {
        { -.1, 0, 0, 0, 4, 3 },           { 5, 0, 0, 5.1, 4, 3 },
        { 0, 4, 0, 5, 4.1, 3 },           { 0, 0, -.1, 5, 4, 0 },
        { 0, 0, 3, 5, 4, 3.1 },           { 0, -.1, 0, 2, 0, 3 },
        { 3.5, -.1, 0, 5, 0, 3 },         { 2, -.1, 0, 3.5, 0, 1 },
        { 1, 2, .7, 3, 3, .74 },          { 1, 2, 0, 1.05, 2.05, .7 },
        { 2.95, 2, 0, 3, 2.05, .7 },      { 1, 2.95, 0, 1.05, 3, .7 },
        { 2.95, 2.95, 0, 3, 3, .7 },      { 2.3, 2.2, .1, 2.9, 3, .7 },
        { 3.4, 2.6, 0, 3.9, 3.1, .45 },   { 3.4, 3.05, .45, 3.9, 3.1, .95 },
        { .1, 3.6, 0, .9, 3.98, 2.2 },    { 1.2, 2.7, .74, 1.5, 2.9, .8 },
        { 1.22, 2.72, .8, 1.5, 2.9, .86 }
    };

    double lit = p->dark ? 0 : 1;

    add(t,
        "void plastic paint 0 0 5 .6 .5 .4 0 0\n"
        "void plastic varnish 0 0 5 .4 .25 .1 .04 0\n"
        "void metal brass 0 0 5 .7 .6 .3 .9 0\n"
        "void glass pane 0 0 3 .9 .95 .9\n"
        "void light lamp 0 0 3 %g %g %g\n"
        "void light sun 0 0 3 %g %g %g\n"
        "sun source s 0 0 4 .3 -.8 .6 .5\n",
        20 * lit, 20 * lit, 18 * lit, 1e5 * lit, 9e4 * lit, 8e4 * lit);
    for (size_t i = 0; i < sizeof box / sizeof box[0]; i++)
        add_box(t, p, i < 8 ? "paint" : "varnish", box[i], box[i] + 3);
    add(t, "pane polygon g 0 0 12");
    add_point(t, p, 2, -.05, 1);
    add_point(t, p, 3.5, -.05, 1);
    add_point(t, p, 3.5, -.05, 3);
    add_point(t, p, 2, -.05, 3);
    add(t, "\nlamp polygon l 0 0 12");
    add_point(t, p, 2, 1.5, 3);
    add_point(t, p, 2, 2.5, 3);
    add_point(t, p, 3, 2.5, 3);
    add_point(t, p, 3, 1.5, 3);
    add(t, "\nbrass sphere b 0 0 4");
    add_point(t, p, 2, 2.4, .94);
    add(t, " %.17g\npaint cone c 0 0 8", .2 * p->scale);
    add_point(t, p, 2.6, 2.5, .74);
    add_point(t, p, 2.6, 2.5, .95);
    add(t, " %.17g %.17g\nbrass cylinder y 0 0 7", .05 * p->scale,
        .12 * p->scale);
    add_point(t, p, .5, .5, 0);
    add_point(t, p, .5, .5, 1.6);
    add(t, " %.17g\nlamp sphere o 0 0 4", .02 * p->scale);
    add_point(t, p, .5, .5, 1.75);
    add(t, " %.17g\n", .1 * p->scale);
}

enum { WIDE = 80, HIGH = 64 };

static void
render_room(const struct place *p, struct rad_rgb picture[WIDE * HIGH])
{
    struct text t = { NULL, 0, 0 };
    struct rad_error err = { 0 };
    struct rad_frame f;
    struct rad_view v;
    struct stage s = { 0 };

    add_room(&t, p);
    stage_open(&s,
               "-ps 1 -pj 0 -pa 1 -x 80 -y 64 -dt 0 -ds .2 -dj 0 -ss 0 -st .1 "
               "-lw 1e-3",
               "%s", t.at);
    rad_view_init(&v);
    for (int k = 0; k < 3; k++)
        v.vp[k] = at(p, (const double[3]){ 4.3, .4, 1.7 }[k]);
    rad_copy(v.vdir, ((const double[3]){ -.65, .65, -.25 }));
    v.horiz = 75;
    v.vert = 63.1;
    if (rad_frame_init(&f, s.job, &v, 0, false, &err) < 0 || f.width != WIDE ||
        f.height > HIGH) {
        fprintf(stderr, "accuracy: %s %dx%d\n", err.what, f.width, f.height);
        exit(EXIT_FAILURE);
    }
    for (int i = 0; i < WIDE * HIGH; i++)
        picture[i] = rad_grey(0);
    for (int i = 0; i < f.width * f.height; i++) {
        struct rad_pixel out;

        rad_frame_pixel(&f, &s.ctx, i % WIDE, i / WIDE, &out);
        picture[i] = out.L;
    }
    rad_frame_release(&f);
    stage_close(&s);
    free(t.at);
}

/* Share of the pixels of two pictures that differ by more than 1e-4. */
static double
share_apart(const struct place *p, const struct place *q)
{
    static struct rad_rgb a[WIDE * HIGH], b[WIDE * HIGH];
    int apart = 0;

    render_room(p, a);
    render_room(q, b);
    for (int i = 0; i < WIDE * HIGH; i++) {
        double x = a[i].g, y = b[i].g;

        apart += !(fabs(x - y) <= 1e-4 * fmax(x, y));
    }
    return (double)apart / (WIDE * HIGH);
}

static double
scaled(struct stage *s, const double *a)
{
    struct place home = { 1, 0, false, false }, there = home;

    (void)s;
    there.scale = a[0];
    return share_apart(&home, &there);
}

static double
moved(struct stage *s, const double *a)
{
    struct place back = { 1, a[0], true, false }, there = back;

    (void)s;
    there.back = false;
    return share_apart(&back, &there);
}

/* --- leaks from edges --- */

/* A dark box of size a[0] at a[1] in light, seen from within: of rays to its
 * edges and corners, those that find light, for others leave from there. */
static double
leaks_from_edges(struct stage *s, const double *a)
{
    const double lo[3] = { -1, -1, -1 }, hi[3] = { 1, 1, 1 };
    const struct place p = { .scale = a[0], .offset = a[1] };
    struct text t = { NULL, 0, 0 };
    int lit = 0;

    add_box(&t, &p, "w", lo, hi);
    stage_open(s, "-ab 1 -aa 0 -ad 64 -as 0 -dj 0",
               "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid glow g 0 0 4 1 1 1 0\n"
               "void light l 0 0 3 1e6 1e6 1e6\n"
               "g source s 0 0 4 0 0 1 360\nl source m 0 0 4 1 2 3 1\n%s",
               t.at);
    for (int i = 0; i < 600 * s->effort; i++) {
        uint64_t key = rad_key_branch(17, (uint64_t)i);
        double from[3], dir[3];

        for (int k = 0; k < 3; k++) {
            double eye = i % 2 ? rad_rand(key, (uint32_t)k) - .5 : 0;
            double to = rad_rand(key, 3 + (uint32_t)k) < .5 ? -1 : 1;

            if (k == i / 2 % 4) /* none of the coordinates: a corner */
                to = 2 * rad_rand(key, 6) - 1;
            from[k] = at(&p, eye);
            dir[k] = at(&p, to) - from[k];
        }
        lit += stage_radiance(s, from, dir, key) > 0;
    }
    free(t.at);
    return lit;
}

/* --- acne --- */

/* Share of places on a ball of radius a[0] that a sun, or with a[1] a ceiling
 * lamp, does not light as it lights a plane; a ball stands on it. */
static double
acne(struct stage *s, const double *a)
{
    static const double down[3] = { 0, 0, -1 };
    int n = 20000 * s->effort, wrong = 0;
    double half = sin(M_PI / 720), truth;

    stage_open(s, "-dt 0",
               "void plastic p 0 0 5 .5 .5 .5 0 0\n"
               "p sphere ground 0 0 4 0 0 %.17g %.17g\n"
               "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 .6 0 .8 "
               ".5\n",
               -a[0], a[0]);
    truth = .5e6 * half * half;
    for (int i = 0; i < n; i++) {
        uint64_t key = rad_key_branch(3, (uint64_t)i);
        double p[3] = { 2e-4 * a[0] * (rad_rand(key, 0) - .5),
                        2e-4 * a[0] * (rad_rand(key, 1) - .5), 1e-4 * a[0] };
        double nz, L = stage_radiance(s, p, down, key);

        /* the normal leans with the place */
        nz = sqrt(1 - (p[0] * p[0] + p[1] * p[1]) / (a[0] * a[0]));
        wrong += !(fabs(L / (truth * (.6 * p[0] / a[0] + .8 * nz)) - 1) < 1e-5);
    }
    return (double)wrong / n;
}

/* --- one scene each --- */

static const double up[3] = { 0, 0, 1 };

/* Share of places on a floor that a point-like sun a[0] degrees above the
 * horizon does not light as it should. */
static double
grazing_sun(struct stage *s, const double *a)
{
    double t = a[0] * M_PI / 180, half = M_PI / 360 * 1e-4, truth;
    int n = 20000 * s->effort, wrong = 0;

    stage_open(s, "-dt 0",
               "void plastic p 0 0 5 .5 .5 .5 0 0\n"
               "p polygon f 0 0 12 -9 -9 .1 9 -9 .1 9 9 .1 -9 9 .1\n"
               "void light l 0 0 3 1e20 1e20 1e20\n"
               "l source sun 0 0 4 %.17g 0 %.17g 1e-4\n",
               cos(t), sin(t));
    truth = .5e20 * half * half * sin(t);
    for (int i = 0; i < n; i++) {
        uint64_t key = rad_key_branch(4, (uint64_t)i);
        double p[3] = { 16 * rad_rand(key, 0) - 8, 16 * rad_rand(key, 1) - 8,
                        3 };
        double way[3] = { .3 * rad_rand(key, 2), .3 * rad_rand(key, 3), -1 };

        if (fabs(p[0] + 2.9 * way[0]) < 9 && fabs(p[1] + 2.9 * way[1]) < 9)
            wrong += !(fabs(stage_radiance(s, p, way, key) / truth - 1) < 1e-3);
    }
    return (double)wrong / n;
}

/* Share of rays at a[0] radians to a floor, from a ten thousandth of its size
 * above it, that do not meet it where they should, to 1e-9 of the way. */
static double
grazing_rays(struct stage *s, const double *a)
{
    struct rad_geom_counts counts = { 0 };
    int n = 20000 * s->effort, wrong = 0;

    stage_open(s, "",
               "void plastic p 0 0 5 .5 .5 .5 0 0\n"
               "p polygon f 0 0 12 -9 -9 .1 9 -9 .1 9 9 .1 -9 9 .1\n");
    for (int i = 0; i < n; i++) {
        uint64_t key = rad_key_branch(5, (uint64_t)i);
        double phi = 2 * M_PI * rad_rand(key, 0), way = 8 * rad_rand(key, 1);
        struct rad_span span = { { 0, 0, .1 + way * tan(a[0]) },
                                 { cos(a[0]) * cos(phi), cos(a[0]) * sin(phi),
                                   -sin(a[0]) },
                                 0,
                                 INFINITY };
        struct rad_hit hit;

        wrong += !rad_geom_nearest(s->job->geom, &span, &hit, &counts) ||
                 !(fabs(hit.t * cos(a[0]) - way) <= 1e-9 + 2e-16 / a[0]) ||
                 !(fabs(hit.p[2] - .1) <= hit.err);
    }
    return (double)wrong / n;
}

/* Share of a wall whose face shows another one at the same place, or closer
 * behind it than rounding can tell, through it: the modifier defined later
 * wins. */
static double
coincident(struct stage *s, const double *a)
{
    static const double eye[3] = { .1, .2, 3 };
    int n = 20000 * s->effort, wrong = 0;

    stage_open(s, "",
               "void glow under 0 0 4 1 1 1 0\nvoid glow over 0 0 4 2 2 2 0\n"
               "over polygon o 0 0 12 -1 -1 .7 1 -1 .3 1 1 .1 -1 1 .5\n"
               "under polygon u 0 0 9 -1 -1 .7 1 -1 .3 1 1 .1\n"
               "under polygon v 0 0 9 -1 -1 .7 1 1 .1 -1 1 .5\n");
    for (int i = 0; i < n; i++) {
        uint64_t key = rad_key_branch(6, (uint64_t)i);
        double to[3] = { 1.9 * rad_rand(key, 0) - .95,
                         1.9 * rad_rand(key, 1) - .95, 0 };

        to[2] = .4 - .2 * (to[0] + .5 * to[1]);
        rad_sub(to, to, eye);
        wrong += stage_radiance(s, eye, to, key) != 2;
    }
    (void)a;
    return (double)wrong / n;
}

/* A lamp in the plane of its ceiling: relative error of the light below. */
static double
flush_lamp(struct stage *s, const double *a)
{
    static const double p[3] = { 1, .5, 0 };
    double x = hypot(1, .5), z = 4 + x * x + .25;
    double truth = M_PI / 2 * (1 - (z - .5) / sqrt(z * z - x * x));

    (void)a;
    stage_open(s, "-dt 0 -ds .2",
               "void plastic p 0 0 5 .5 .5 .5 0 0\n"
               "p polygon ceiling 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2\n"
               "p polygon floor 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
               "void light l 0 0 3 1 1 1\nl ring r 0 0 8 0 0 2 0 0 -1 0 .5\n");
    return fabs(stage_irradiance(s, p, up) / truth - 1);
}

/* The largest radiance in a closed box that touches a lit one, with indirect
 * light interpolated over both. */
static double
dark_box(struct stage *s, const double *a)
{
    double most = 0;
    int n = 200;

    (void)a;
    stage_open(s, "-ab 2 -aa .2 -ad 64 -as 0 -ar 32 -dt 0",
               "void plastic p 0 0 5 .7 .7 .7 0 0\n"
               "void light l 0 0 3 100 100 100\nl sphere b 0 0 4 -1 0 0 .2\n"
               "p polygon w 0 0 12 0 -1 -1 0 1 -1 0 1 1 0 -1 1\n"
               "p polygon f 0 0 12 -2 -1 -1 2 -1 -1 2 1 -1 -2 1 -1\n"
               "p polygon c 0 0 12 -2 -1 1 -2 1 1 2 1 1 2 -1 1\n"
               "p polygon s 0 0 12 -2 -1 -1 -2 -1 1 2 -1 1 2 -1 -1\n"
               "p polygon t 0 0 12 -2 1 -1 2 1 -1 2 1 1 -2 1 1\n"
               "p polygon e 0 0 12 2 -1 -1 2 -1 1 2 1 1 2 1 -1\n"
               "p polygon d 0 0 12 -2 -1 -1 -2 1 -1 -2 1 1 -2 -1 1\n");
    for (int i = 0; i < n; i++) {
        uint64_t key = rad_key_branch(7, (uint64_t)i);
        double lit[3] = { -1, 0, -.5 }, dark[3] = { 1, 0, -.5 }, way[3];

        for (uint32_t k = 0; k < 3; k++)
            way[k] = 2 * rad_rand(key, k) - 1;
        if (i % 2 == 0)
            stage_radiance(s, lit, way, key);
        else
            most = fmax(most, stage_radiance(s, dark, way, key));
    }
    return most;
}

/* a[0] lamps: relative error of their sum. */
static double
many_lamps(struct stage *s, const double *a)
{
    static const double p[3] = { 0, 0, 0 };
    struct text t = { NULL, 0, 0 };
    double truth = 0, found;

    add(&t, "void light l 0 0 3 1 1 1\n");
    for (int i = 0; i < (int)a[0]; i++) {
        uint64_t key = rad_key_branch(9, (uint64_t)i);
        double c[3] = { 9 * rad_rand(key, 0), 9 * rad_rand(key, 1),
                        3 + rad_rand(key, 2) };
        double d2 = rad_dot(c, c);

        add(&t, "l sphere s 0 0 4 %.17g %.17g %.17g 1e-3\n", c[0], c[1], c[2]);
        truth += M_PI * 1e-6 * c[2] / (d2 * sqrt(d2));
    }
    stage_open(s, "-dt 0", "%s", t.at);
    found = stage_irradiance(s, p, up);
    free(t.at);
    return fabs(found / truth - 1);
}

/* All that a scene without light sends, with every kind of ray. */
static double
black_scene(struct stage *s, const double *a)
{
    double sum = 0;
    struct text t = { NULL, 0, 0 };
    struct place dark = { 1, 0, false, true };

    (void)a;
    add_room(&t, &dark);
    stage_open(s, "-ab 1 -aa .3 -ad 16 -as 0", "%s", t.at);
    for (int i = 0; i < 200 * s->effort; i++) {
        uint64_t key = rad_key_branch(10, (uint64_t)i);
        double eye[3] = { 4.3, .4, 1.7 }, way[3];

        for (uint32_t k = 0; k < 3; k++)
            way[k] = 2 * rad_rand(key, k) - 1;
        sum += stage_radiance(s, eye, way, key);
    }
    sum += (double)s->ctx.counts.unsound_rays;
    free(t.at);
    return sum;
}

/* Relative error of what a[0] clear panes, one behind another, let through. */
static double
many_panes(struct stage *s, const double *a)
{
    static const double eye[3] = { 0, 0, 1 }, down[3] = { .1, 0, -1 };
    struct text t = { NULL, 0, 0 };
    double found;

    add(&t, "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 -1 180\n"
            "void glass pane 0 0 4 .999 .999 .999 1\n");
    for (int i = 0; i < (int)a[0]; i++)
        add(&t, "pane ring r 0 0 8 0 0 %.17g 0 0 1 0 99\n", -1e-3 * i);
    stage_open(s, "-lw 0 -lr 9", "%s", t.at);
    found = stage_radiance(s, eye, down, 1);
    free(t.at);
    return fabs(found / pow(.999, a[0] * sqrt(1.01)) - 1);
}

/* Relative error of the area of a concave polygon with a hole on a seam. */
static double
seamed_area(struct stage *s, const double *a)
{
    static const char view[] = "VIEW= -vtl -vp 0 -3 0 -vd 0 1 0 -vh 2 -vv 2";

    (void)a;
    stage_open(s, "-ps 1 -pj 1 -x 400 -y 400",
               "void glow g 0 0 4 1 1 1 0\n"
               "g polygon p 0 0 36 -.9 0 -.9 0 0 -.5 .9 0 -.9 .6 0 .8 0 0 .2 "
               "-.6 0 .8 -.9 0 -.9 -.3 0 -.3 -.3 0 0 .2 0 .1 .3 0 -.3 "
               "-.3 0 -.3\n");
    /* Gauss's formula for the outline, less that for the hole */
    return fabs(stage_lit_area(s, view) / (1.83 - .195) - 1);
}

const struct hard_row hard_rows[] = {
    /* clang-format off */
    { "leaks at edges and vertices, size 1", leaks, { 1, 0 }, 0 },
    { "the same, size 1e-6", leaks, { 1e-6, 0 }, 0 },
    { "the same, size 1e9", leaks, { 1e9, 0 }, 0 },
    { "the same, size 10 at 1e9", leaks, { 10, 1e9 }, 0 },
    { "leaks from edges and corners, size 1", leaks_from_edges, { 1, 0 }, 0 },
    { "the same, size 1e-6", leaks_from_edges, { 1e-6, 0 }, 0 },
    { "the same, size 10 at 1e9", leaks_from_edges, { 10, 1e9 }, 0 },
    { "room scaled by 1e-6: pixels apart", scaled, { 1e-6 }, .01 },
    { "room scaled by 1e-3: pixels apart", scaled, { 1e-3 }, .01 },
    { "room scaled by 1e3: pixels apart", scaled, { 1e3 }, .01 },
    { "room scaled by 1e6: pixels apart", scaled, { 1e6 }, .01 },
    { "room scaled by 1e9: pixels apart", scaled, { 1e9 }, .01 },
    { "room moved by 1e3: pixels apart", moved, { 1e3 }, .01 },
    { "room moved by 1e6: pixels apart", moved, { 1e6 }, .01 },
    { "room moved by 1e9: pixels apart", moved, { 1e9 }, .01 },
    { "acne on a ball of radius 1e10", acne, { 1e10 }, 0 },
    { "acne on a ball of radius 1e-10", acne, { 1e-10 }, 0 },
    { "acne under a sun at 0.01 degrees", grazing_sun, { .01 }, 0 },
    { "rays at 1e-6 rad that miss their place", grazing_rays, { 1e-6 }, 0 },
    { "coincident faces: rays that see the wrong one", coincident, { 0 }, 0 },
    { "lamp flush with its ceiling: error", flush_lamp, { 0 }, 1e-5 },
    { "dark box beside a lit one: radiance", dark_box, { 0 }, 0 },
    { "10 000 lamps: error", many_lamps, { 10000 }, 1e-4 },
    { "scene without light: radiance", black_scene, { 0 }, 0 },
    { "1000 panes: error", many_panes, { 1000 }, 1e-4 },
    { "concave polygon with a hole: error of its area", seamed_area, { 0 },
      2e-3 },
    { NULL, NULL, { 0 }, 0 }
    /* clang-format on */
};
