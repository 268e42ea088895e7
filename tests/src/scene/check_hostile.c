/* check_hostile.c - scenes of every kind with hostile arguments
 *
 * The scenes of tests/scenes, and a few more, have some of their arguments
 * replaced: numbers by 0, 1e30, 1e-30 and the like, lists by none at all or by
 * far too long ones, strings by expressions without a value, names of nothing
 * and names of great length; the numbers in the files that they name likewise.
 * Last, what no text can say: NaN and infinity in the scene itself.  Each is
 * refused with words, or it renders, and each pixel is finite and not negative.
 * HOSTILE_SCENES=N tries so many, in place of 1000. */
#include "config.h"

#include "base/rng.h"
#include "scene/octree.h"
#include "scene/octfile.h"
#include "scene/part.h"
#include "wild.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>

enum { MAX_SCENES = 64, MAX_TOKENS = 4000, HUGE_LIST = 1500, PARTS = 8 };

static const char *const words[] = {
    "0",     "-0",     "1e-30",  "-1e-30", "1e30",    "-1e30", "1",
    "-1",    "1e-300", "1e300",  "-1e300", "1.7e308", "1e16",  "1e-16",
    "1e9",   "-1e9",   "90",     "360",    "3.4e38",  "1e39",  "5e-324",
    "1e150", "1e-150", ".99999", "1e8",    "nan",     "inf",   "-inf",
};

/* In place of strings: names and expressions. */
static const char *const strings[] = {
    "void",
    "none",
    "0",
    "1e30",
    "-1e30",
    "1/0",
    "0/0",
    "log(0)",
    "sqrt(-1)",
    "1e300*1e300",
    "asin(2)",
    "-Px/0",
    "A1/A2",
    "A9",
    "exp(1e5)",
    "Nx^-1e30",
    "if(Px,1/0,)",
    "arg(1e30)",
    "rand(1e300*Px)",
    "%s%n",
};

/* Every type that the scenes of the folder lack, and lamps. */
static const char more[] =
    "void light lamp 0 0 3 9 9 9\nvoid spotlight spot 0 0 7 9 9 9 60 0 0 -1\n"
    "void glow near 0 0 4 2 2 2 3\nvoid plastic grey 0 0 5 .5 .5 .5 .05 .1\n"
    "void metal brass 0 0 5 .7 .6 .3 .9 .1\nvoid trans sheet 0 0 7 .5 .5 .5 "
    ".05 .1 .5 .5\nvoid glass pane 0 0 4 .9 .9 .9 1.5\n"
    "void dielectric water 0 0 5 .9 .8 .7 1.33 3\n"
    "void interface both 0 0 8 .9 .9 .9 1.5 .8 .8 .8 1.3\n"
    "void mirror glassy 1 grey 0 3 .9 .9 .9\nvoid illum window 1 pane 0 3 3 3 "
    "3\nvoid mist fog 2 ball m>ball 0 7 .1 .2 .3 .9 .8 .7 .4\n"
    "void antimatter hole 2 void grey 0 0\n"
    "void brightfunc rough 2 .5+.5*fnoise3(Px,Py,Pz) . 0 1 2\n"
    "rough colorfunc hue 4 Nx*A1 Ny/A2 Nz . 0 2 1 2\n"
    "hue texfunc bump 5 .1*sin(Px) .1/Py A1 . -s 0 1 .1\n"
    "void mixfunc mixed 4 grey brass Px/Py . 0 0\n"
    "bump plastic wavy 0 0 5 .5 .5 .5 .2 0\n"
    "lamp ring r 0 0 8 1 1 4 0 0 -1 .1 .5\nlamp sphere ball 0 0 4 -1 1 3 .2\n"
    "spot ring s 0 0 8 0 1 4.5 0 0 -1 0 .2\nlamp cylinder c 0 0 7 2 0 3 2 2 3 "
    ".1\nnear polygon n 0 0 9 -2 2 3 -1.5 2 3 -1.5 2.5 3\n"
    "lamp source sun 0 0 4 .3 -.4 .8 .5\n"
    "glassy polygon m 0 0 12 4 -3 0 4 5 0 4 5 4 4 -3 4\n"
    "grey polygon f 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n"
    "window polygon w 0 0 12 -4 -1 1 -4 1 1 -4 1 2 -4 -1 2\n"
    "water sphere w 0 0 4 0 1 1 .7\nboth bubble b 0 0 4 0 1 1 .4\n"
    "fog sphere g 0 0 4 1 1 2 1.5\nhole sphere h 0 0 4 2 2 0 .5\n"
    "mixed cone o 0 0 8 -1 -1 0 -1 -1 1 .5 .1\nwavy cup u 0 0 8 1 -1 .5 1 -1 "
    "1 .2 .4\nbrass tube t 0 0 7 -2 1 .5 -2 1 2 .2\nsheet ring q 0 0 8 2 -1 1 "
    "-1 1 0 0 .5\n";

/* --- the scenes as they are --- */

static char *scenes[MAX_SCENES];
static int nscenes;

static char *
slurp(const char *name, size_t *len)
{
    char path[500];

    snprintf(path, sizeof path, "%s/tests/scenes/%s", getenv("top_srcdir"),
             name);
    return (char *)rad_file_read(path, 1 << 24, len, NULL);
}

static int
by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static int
is_scene(const struct dirent *d)
{
    size_t n = strlen(d->d_name);

    return n > 4 && strcmp(d->d_name + n - 4, ".rad") == 0;
}

static void
load_scenes(void)
{
    struct dirent **list;
    char path[500];
    int n;

    ck_assert_msg(getenv("top_srcdir") != NULL, "top_srcdir is not set");
    snprintf(path, sizeof path, "%s/tests/scenes", getenv("top_srcdir"));
    n = scandir(path, &list, is_scene, by_name);
    ck_assert_int_gt(n, 5);
    ck_assert_int_lt(n, MAX_SCENES / 2);
    for (int i = 0; i < n; i++) {
        size_t len;

        scenes[nscenes++] = slurp(list[i]->d_name, &len);
        free(list[i]);
        /* half of all turns are for the types that come oftenest */
        scenes[nscenes++] = strdup(more);
    }
    free(list);
}

/* --- files that scenes name --- */

struct library {
    uint64_t key; /* of what is changed in them; 0: nothing */
};

static uint32_t
pick(uint64_t key, uint32_t dim, size_t n)
{
    return (uint32_t)(rad_rand(key, dim) * (double)n);
}

/* Overwrite some numbers in a file's text. */
static void
spoil(char *text, size_t len, uint64_t key)
{
    for (size_t i = 0; i < len; i++) {
        size_t n = strspn(text + i, "0123456789.e-");
        const char *w = words[pick(key, (uint32_t)(2 * i + 1), 25)];

        if (n > 0 && strlen(w) <= n && (i == 0 || text[i - 1] <= ' ') &&
            rad_rand(key, (uint32_t)(2 * i)) < .1) {
            memset(text + i, ' ', n);
            memcpy(text + i, w, strlen(w));
        }
        i += n;
    }
}

static unsigned char *read_file(void *arg, const char *name, size_t *len,
                                struct rad_error *err);

/* A frozen octree of the scene of the same name. */
static unsigned char *
freeze(const char *name, size_t *len, struct rad_error *err)
{
    struct rad_memory_out bytes = { NULL, 0, 0 };
    struct rad_sink sink = rad_memory_sink(&bytes);
    struct library as_it_is = { 0 };
    struct rad_files files = { .read = read_file, .arg = &as_it_is };
    struct rad_scene *s = rad_scene_new();
    struct rad_octree tree = { 0 };
    char rad[64], *text;
    size_t n;

    snprintf(rad, sizeof rad, "%.*s.rad", (int)strlen(name) - 4, name);
    text = slurp(rad, &n);
    if (!text) {
        rad_fail(err, RAD_ENOINPUT, "no file '%s'", name);
    } else if (rad_parse_text(s, text, n, rad, NULL, err) == 0 &&
               rad_scene_include(s, &files, NULL, NULL, err) == 0 &&
               rad_octree_build(&tree, s, RAD_OCTREE_LEAF, err) == 0) {
        ck_assert_int_eq(rad_octfile_write(s, &tree, &sink, err), 0);
        *len = bytes.len;
    }
    free(text);
    rad_octree_release(&tree);
    rad_scene_free(s);
    return bytes.bytes;
}

static unsigned char *
read_file(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    struct library *lib = arg;
    size_t n = strlen(name);
    char *text;

    if (n > 4 && n < 60 && strcmp(name + n - 4, ".oct") == 0)
        return freeze(name, len, err);
    text = n < 60 && !strchr(name, '/') ? slurp(name, len) : NULL;
    if (!text)
        rad_fail(err, RAD_ENOINPUT, "no file '%.80s'", name);
    else if (lib->key && n > 4 && strcmp(name + n - 4, ".rtm") != 0)
        spoil(text, *len, lib->key);
    return (unsigned char *)text;
}

/* --- the changes --- */

/* One list of arguments, from its count on; at most one way to spoil it.
 * Returns the tokens that it had. */
static int
copy_list(FILE *t, char *const *token, int left, const char *const *evil,
          size_t nevil, uint64_t key)
{
    int n = left > 0 ? atoi(token[0]) : 0, count;
    double u = rad_rand(key, 0);
    static char name[3001];

    if (n > left - 1)
        n = left - 1;
    count = u < .01 ? 0 : u < .02 ? HUGE_LIST : u < .03 ? n + 1 : n;
    if (u >= .03 && u < .04 && n > 0)
        count = n - 1;
    fprintf(t, "%d ", count);
    memset(name, 'x', sizeof name - 1);
    for (int i = 0; i < count; i++) {
        uint32_t dim = 3 * (uint32_t)i + 1;

        if (rad_rand(key, dim) < .12)
            fprintf(t, "%s ", evil[pick(key, dim + 1, nevil)]);
        else if (evil == strings && rad_rand(key, dim + 2) < .01)
            fprintf(t, "%s ", name);
        else
            fprintf(t, "%s ", n > 0 ? token[1 + i % n] : "1");
    }
    return n + 1;
}

static int
copy_plain(FILE *t, char *const *token, int left)
{
    int n = left > 0 ? atoi(token[0]) + 1 : 0;

    if (n > left)
        n = left;
    for (int i = 0; i < n; i++)
        fprintf(t, "%s ", token[i]);
    return n;
}

static int
cut(char *text, char *token[MAX_TOKENS])
{
    char *save, *line = text;
    int n = 0;

    for (char *l = strtok_r(line, "\n", &save); l;
         l = strtok_r(NULL, "\n", &save)) {
        char *words_of = NULL;

        l[strcspn(l, "#")] = '\0';
        for (char *w = strtok_r(l, " \t\r", &words_of); w && n < MAX_TOKENS;
             w = strtok_r(NULL, " \t\r", &words_of))
            token[n++] = w;
    }
    return n;
}

/* The text of a scene with some of its primitives changed. */
static void
change(FILE *t, const char *original, uint64_t key)
{
    static char *token[MAX_TOKENS];
    char *copy = strdup(original);
    int n = cut(copy, token), i = 0;

    for (uint32_t k = 0; i + 3 < n; k++) {
        uint64_t mine = rad_key_branch(key, k);
        bool evil = rad_rand(mine, 0) < .12;
        bool alias = strcmp(token[i + 1], "alias") == 0;

        for (int j = 0; j < 3 + alias; j++)
            fprintf(t, "%s ", token[i++]);
        if (alias)
            continue;
        if (evil) {
            i += copy_list(t, token + i, n - i, strings, N_ELEM(strings),
                           rad_key_branch(mine, 1));
            i += copy_plain(t, token + i, n - i);
            i += copy_list(t, token + i, n - i, words, N_ELEM(words) - 3,
                           rad_key_branch(mine, 2));
        } else {
            for (int j = 0; j < 3; j++)
                i += copy_plain(t, token + i, n - i);
        }
        fprintf(t, "\n ");
    }
    free(copy);
}

/* What only damaged memory or another program's octree could hold. */
static void
poison(struct rad_scene *s, uint64_t key)
{
    static const double bad[] = { NAN, INFINITY, -INFINITY, 1e308, -1e308, 0 };

    for (uint32_t k = 0; k < 3 && s->nobjects > 0; k++) {
        const struct rad_object *o =
            &s->objects[pick(key, 3 * k, (size_t)s->nobjects)];

        if (o->nreals > 0)
            ((double *)o->reals)[pick(key, 3 * k + 1, (size_t)o->nreals)] =
                bad[pick(key, 3 * k + 2, N_ELEM(bad))];
    }
}

/* --- rendering --- */

static const char *const options[] = {
    "-dj 0 -dt .05 -ds .2 -ss 1 -dr 2 -dp 16",
    "-dj .9 -dt 0 -ds .05 -ps 4 -pj 1 -pd .3 -ms .5",
    "-dj .5 -ab 1 -aa .3 -ad 16 -as 0 -ar 16 -av .1 .1 .1 -dp 16",
    "-dj .5 -ab 2 -aa 0 -ad 4 -lr -4 -lw .001 -ds 0 -dp 0",
    "-me .1 .2 1e30 -ma 1 1e30 .5 -mg .9 -ms 1e-30 -av 1e30 1 1 -dp 16",
    "-i -dj 1e30 -ds 1e-30 -dt 1e30 -dc 1e30 -st 1e30 -ss 1e30 -dp 16",
    "-pXYZ -lw 0 -lr 3 -ds 1e30 -av 3e38 3e38 3e38 -pj 1e30 -dp 16",
};

static const char *const views[] = {
    "VIEW= -vp 0 -4 1.5 -vd 0 1 0 -vu 0 0 1",
    "VIEW= -vta -vp 0 1 2 -vd 0 0 -1 -vu 0 1 0 -vh 270 -vv 270",
    "VIEW= -vp 1e30 -1e30 1e30 -vd -1 1 -1 -vu 0 0 1 -vh 1e-3 -vv 1e-3",
    ("VIEW= -vtl -vp 0 0 1e9 -vd 0 0 -1e-30 -vu 0 1 0 -vh 1e30 -vv 1e30 -vo "
     "1e30"),
};

/* Did it render? */
static bool
try(const char *text, size_t len, uint64_t key)
{
    struct library lib = { rad_rand(key, 2) < .3 ? rad_key_branch(key, 9) : 0 };
    struct rad_files files = { .read = read_file, .arg = &lib };
    struct world w = { .scene = rad_scene_new() };
    int rc = rad_parse_text(w.scene, text, len, "hostile.rad", NULL, &w.err);

    if (rc == 0)
        rc = rad_scene_include(w.scene, &files, NULL, NULL, &w.err);
    if (rc == 0 && rad_rand(key, 3) < .3)
        poison(w.scene, rad_key_branch(key, 10));
    if (rc == 0)
        rc = rad_scene_check(w.scene, NULL, NULL, &w.err);
    if (!wild_refused(rc, RAD_ENOINPUT, &w.err, text)) {
        rad_params_init(&w.params);
        world_options(&w, options[pick(key, 4, N_ELEM(options))]);
        w.params.xres = w.params.yres = WILD_SIDE;
        w.job = rad_job_new(w.scene, &w.params, &files, &w.err);
        rc = w.job ? 0 : w.err.code;
        if (!wild_refused(rc, RAD_ENOINPUT, &w.err, text))
            wild_look(w.job, views[pick(key, 5, N_ELEM(views))], INFINITY,
                      text);
    }
    rad_job_free(w.job);
    rad_scene_free(w.scene);
    return rc == 0;
}

LOOP_TEST(hostile_scenes_are_refused_or_rendered, PARTS)
{
    const char *many = getenv("HOSTILE_SCENES");
    long n = many ? atol(many) : 1000, part = (n + PARTS - 1) / PARTS;
    int rendered = 0;

    load_scenes();
    for (long i = _i * part; i < (_i + 1) * part; i++) {
        uint64_t key = rad_key_branch(11, (uint64_t)i);
        char *text;
        size_t len;
        FILE *t = open_memstream(&text, &len);

        ck_assert_ptr_nonnull(t);
        change(t, scenes[pick(key, 1, (size_t)nscenes)], key);
        ck_assert_int_eq(fclose(t), 0);
        rendered += try(text, len, key);
        free(text);
    }
    for (int i = 0; i < nscenes; i++)
        free(scenes[i]);
    nscenes = 0;
    ck_assert_int_ge(rendered, part / 4); /* the rest is refused */
}
