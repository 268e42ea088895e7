/* check_params.c - rendering options: values, ranges, refusals, round trip */
#include "config.h"

#include "base/files.h"
#include "base/rng.h"
#include "base/number.h"
#include "base/params.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_WORDS = 1024 };

/* Cut a copy of text into words. */
static int
cut_words(char *text, char *argv[MOST_WORDS])
{
    int n = 0;

    for (char *w = strtok(text, " "); w; w = strtok(NULL, " ")) {
        ck_assert_int_lt(n, MOST_WORDS);
        argv[n++] = w;
    }
    return n;
}

/* Take all options of text; the first code below 1, or 1. */
static int
take(struct rad_params *into, const char *text, struct rad_error *err)
{
    char copy[2 * RAD_PARAMS_TEXT], *argv[MOST_WORDS];
    int argc, rc = 1;

    ck_assert_uint_lt(strlen(text), sizeof copy);
    strcpy(copy, text);
    argc = cut_words(copy, argv);
    for (int i = 0; i < argc; i += rc)
        if ((rc = rad_params_option(into, argc - i, argv + i, err)) < 1)
            return rc;
    return rc;
}

static struct rad_params p;

static void
set_up(void)
{
    rad_params_init(&p);
}

FIXTURE(set_up, NULL)

TEST(defaults_are_those_of_rpict)
{
    ck_assert_int_eq(p.xres, 512);
    ck_assert_int_eq(p.yres, 512);
    ck_assert_double_eq(p.pixaspect, 1);
    ck_assert_double_eq(p.pixjitter, .67);
    ck_assert_int_eq(p.psample, 4);
    ck_assert_double_eq(p.maxdiff, .05);
    ck_assert(p.directvis && p.backvis && !p.irradiance && !p.rand_samp);
    ck_assert_double_eq(p.shadthresh, .05);
    ck_assert_double_eq(p.shadcert, .5);
    ck_assert_double_eq(p.srcjitter, 0);
    ck_assert_double_eq(p.srcsizerat, .25);
    ck_assert_int_eq(p.directrelay, 1);
    ck_assert_int_eq(p.vspretest, 512);
    ck_assert_double_eq(p.specjitter, 1);
    ck_assert_double_eq(p.specthresh, .15);
    ck_assert(rad_rgb_black(p.ambval) && p.ambvwt == 0 && p.ambounce == 0);
    ck_assert_double_eq(p.ambacc, .2);
    ck_assert_int_eq(p.ambres, 64);
    ck_assert_int_eq(p.ambdiv, 512);
    ck_assert_int_eq(p.ambssamp, 128);
    ck_assert_int_eq(p.maxdepth, 7);
    ck_assert_double_eq(p.minweight, 1e-4);
    ck_assert_uint_eq(p.seed, 0);
    ck_assert_int_eq(rad_params_check(&p, NULL), 0);
}

TEST(options_set_their_field)
{
    ck_assert_int_gt(take(&p,
                          "-x 17 -y 19 -pa 0 -pj .5 -ps 6 -pt 0.1 -i -u "
                          "-bv -dt 1e-3 -dc 1 -dj .9 -ds 0 -dr 2 -dp 0 -dv "
                          "-ss 2 -st 0 -av .1 .2 .3 -aw 1 -ab 2 -aa .25 "
                          "-ar 48 -ad 256 -as 64 -lr -8 -lw .002 --seed 5",
                          NULL),
                     0);
    ck_assert(p.xres == 17 && p.yres == 19 && p.pixaspect == 0);
    ck_assert(p.pixjitter == .5 && p.psample == 6 && p.maxdiff == .1);
    ck_assert(p.irradiance && p.rand_samp && !p.backvis && !p.directvis);
    ck_assert(p.shadthresh == 1e-3 && p.shadcert == 1 && p.srcjitter == .9);
    ck_assert(p.srcsizerat == 0 && p.directrelay == 2 && p.vspretest == 0);
    ck_assert(p.specjitter == 2 && p.specthresh == 0);
    ck_assert(p.ambval.r == .1f && p.ambval.g == .2f && p.ambval.b == .3f);
    ck_assert(p.ambvwt == 1 && p.ambounce == 2 && p.ambacc == .25);
    ck_assert(p.ambres == 48 && p.ambdiv == 256 && p.ambssamp == 64);
    ck_assert(p.maxdepth == -8 && p.minweight == .002 && p.seed == 5);
}

/* what becomes of -dv, which is on at first */
static const struct {
    const char *text;
    bool on;
} switches[] = { { "-dv+", true },      { "-dv-", false },
                 { "-dv", false },      { "-dv1", true },
                 { "-dv0", false },     { "-dv -dv", true },
                 { "-dvy", true },      { "-dvF", false },
                 { "-dv- -dv", true },  { "-dvT", true },
                 { "-dvn -dv+", true }, { "-pRGB -dv-", false } };

LOOP_TEST(booleans_set_clear_and_toggle, N_ELEM(switches))
{
    ck_assert_int_gt(take(&p, switches[_i].text, NULL), 0);
    ck_assert_int_eq(p.directvis, switches[_i].on);
}

TEST(what_is_less_than_0_counts_as_0_where_rpict_takes_it_so)
{
    struct rad_params q = p;

    ck_assert_int_gt(take(&p,
                          "-pm -1 -pd -.1 -dt -.1 -ds -1 -dr -1 -dp -2 -st -1 "
                          "-aw -3 -ab -1 -aa -.1 -ar -1 -ad -5 -as -1 -ms -1 "
                          "-lw -1e-5",
                          NULL),
                     0);
    ck_assert_int_gt(take(&q,
                          "-pm 0 -pd 0 -dt 0 -ds 0 -dr 0 -dp 0 -st 0 -aw 0 "
                          "-ab 0 -aa 0 -ar 0 -ad 0 -as 0 -ms 0 -lw 0",
                          NULL),
                     0);
    ck_assert_mem_eq(&p, &q, sizeof p);
}

static const struct {
    const char *text, *what;
} bad[] = {
    { "-x abc", "option '-x': expected an integer, got 'abc'" },
    { "-x 12.5", "option '-x': expected an integer, got '12.5'" },
    { "-x 99999999999", "option '-x': expected an integer, got "
                        "'99999999999'" },
    { "-x 0", "option '-x': '0' is not between 1 and 1048576" },
    { "-x", "option '-x': expected 1 value, got 0" },
    { "-av 1 2", "option '-av': expected 3 values, got 2" },
    { "-av 1 2 x", "option '-av': expected a number, got 'x'" },
    { "-av 1 2 1e39", "option '-av': '1e39' is not between 0 and "
                      "3.4028234663852886e+38" },
    { "-av 1 2 -1", "option '-av': '-1' is less than 0" },
    { "-dt 1e", "option '-dt': expected a number, got '1e'" },
    { "-dt nan", "option '-dt': expected a number, got 'nan'" },
    { "-dt inf", "option '-dt': expected a number, got 'inf'" },
    { "-dt 0x10", "option '-dt': expected a number, got '0x10'" },
    { "-dt 1e999", "option '-dt': expected a number, got '1e999'" },
    { "-dj -.1", "option '-dj': '-.1' is less than 0" },
    { "-ab 30001", "option '-ab': '30001' is not between 0 and 30000" },
    { "--seed=-1", "option '--seed': expected a whole number from 0 to "
                   "18446744073709551615, got '-1'" },
    { "--seed=18446744073709551616",
      "option '--seed': expected a whole number from 0 to "
      "18446744073709551615, got '18446744073709551616'" },
    { "-pj -1", "option '-pj': '-1' is less than 0" },
    { "-pc 1 1 1 1", "option '-pc': expected 8 values, got 4" },
    { "-pc .7 .3 .2 .7 .1 .1 .3 x", "option '-pc': expected a number, got "
                                    "'x'" },
    { "-pc .7 .3 .7 .3 .1 .1 .3 .3",
      "option '-pc': illegal primary chromaticities" },
    { "-pc .7 .3 .2 .7 .1 .1 .3 0",
      "option '-pc': illegal primary chromaticities" },
    { "-pc .7 .3 .2 9 .1 .1 .3 .3",
      "option '-pc': illegal primary chromaticities" },
    { "-f fun.cal", "option '-f' of rpict is not supported: definitions "
                    "belong in the function files of the scene" },
    { "-ap map 50", "option '-ap' of rpict is not supported: there are no "
                    "photon maps" },
    { "-am 5", "option '-am' of rpict is not supported: there are no photon "
               "maps" },
    { "-am+", "option '-am+' of rpict is not supported: there are no photon "
              "maps" },
    { "-cs 2", "option '-cs': '2' is less than 3" },
    { "-cs x", "option '-cs': expected an integer, got 'x'" },
    { "-cw 380", "option '-cw': expected 2 values, got 1" },
    { "-cw 0 500", "option '-cw': '0' is not between 1 and 1000000" },
    { "--samples=0", "option '--samples': '0' is not between 1 and 1024" },
    { "--plane 9", "option '--plane': '9' is not between -1 and 8" },
    { "--shown 1 2 3", "option '--shown': expected 4 values, got 3" },
    { "--shown 1 x 3 4", "option '--shown': expected a number, got 'x'" },
    { "--shown 1 2 3 0", "option '--shown': the radius '0' is not above 0" },
    { "-ro pic", "option '-ro' of rpict is not supported: a job keeps what is "
                 "rendered and goes on by itself; submit it again" },
    { "-PP file", "option '-PP' of rpict is not supported: the daemons stay, "
                  "and a second job sends no scene again" },
};

static const struct {
    const char *text, *said; /* behind -lw */
    int n, plane;
    double longest, shortest;
} bands[] = {
    { "-cs 3", "--seed=0", 3, -1, 780, 380 },
    { "--samples 1", "--seed=0", 3, -1, 780, 380 },
    { "--samples=4", "--samples 4 --seed=0", 3, -1, 780, 380 },
    { "--surroundings 0", "--seed=0", 3, -1, 780, 380 },
    { "--surroundings=4", "--surroundings 4 --seed=0", 3, -1, 780, 380 },
    { "--surroundings 4 --shown 1e6 -2 -.5 7.25",
      "--surroundings 4 --shown 1000000 -2 -0.5 7.25 --seed=0", 3, -1, 780,
      380 },
    { "-cs 20", "-cs 20 -cw 380 780 --seed=0", 20, -1, 780, 380 },
    { "-cs 99", "-cs 24 -cw 380 780 --seed=0", 24, -1, 780, 380 },
    { "-cw 700 400.5", "-cs 3 -cw 400.5 700 --seed=0", 3, -1, 700, 400.5 },
    { "-cw 400 700 -cs 7 --plane 2", "-cs 7 -cw 400 700 --plane 2 --seed=0", 7,
      2, 700, 400 },
    { "-cs 7 --plane 8", "-cs 7 -cw 380 780 --plane 8 --seed=0", 7, 8, 780,
      380 },
};

LOOP_TEST(bands_are_what_was_asked_for, N_ELEM(bands))
{
    struct rad_params again;
    struct rad_error err = { 0 };
    char text[RAD_PARAMS_TEXT];
    const char *tail;

    ck_assert_int_gt(take(&p, bands[_i].text, &err), 0);
    ck_assert_int_eq(rad_params_check(&p, &err), 0);
    ck_assert_int_eq(p.bands.n, bands[_i].n);
    ck_assert_int_eq(p.bands.plane, bands[_i].plane);
    ck_assert_double_eq(p.bands.longest, bands[_i].longest);
    ck_assert_double_eq(p.bands.shortest, bands[_i].shortest);
    rad_params_format(&p, text, sizeof text);
    tail = strstr(text, "-lw 0.0001 ");
    ck_assert_ptr_nonnull(tail);
    ck_assert_str_eq(tail + 11, bands[_i].said);
    rad_params_init(&again);
    ck_assert_int_gt(take(&again, text, &err), 0);
    ck_assert_mem_eq(&p, &again, sizeof p);
}

static const struct {
    const char *text, *what;
} misfits[] = {
    { "-cs 20 -cw 500 549", "option '-cw 500 549': a range is 50 nm at least" },
    { "-cs 7 --plane 3", "option '--plane 3': -cs 7 has 3 planes, from 0" },
    { "--plane 8", "option '--plane 8': -cs 3 has 1 planes, from 0" },
};

LOOP_TEST(bands_that_cannot_be_are_refused, N_ELEM(misfits))
{
    struct rad_error err = { 0 };

    ck_assert_int_gt(take(&p, misfits[_i].text, &err), 0);
    ck_assert_int_eq(rad_params_check(&p, &err), RAD_EUSAGE);
    ck_assert_str_eq(err.what, misfits[_i].what);
}

/* what rpict has unless told otherwise */
TEST(three_spectral_samples_are_taken)
{
    struct rad_params q;
    struct rad_error err = { 0 };

    rad_params_init(&q);
    ck_assert_int_eq(take(&p, "-cs 3", &err), 2);
    ck_assert_mem_eq(&p, &q, sizeof p);
    ck_assert_int_eq(take(&p, "-cs", &err), RAD_EUSAGE);
}

LOOP_TEST(bad_options_are_named, N_ELEM(bad))
{
    struct rad_error err = { 0 };

    ck_assert_int_eq(take(&p, bad[_i].text, &err), RAD_EUSAGE);
    ck_assert_str_eq(err.what, bad[_i].what);
}

TEST(other_words_are_left_alone)
{
    static const char *const words[] = { "scene.oct", "-vp", "-vf", "-dtx",
                                         "-dvx",      "-",   "-o",  "--see",
                                         "-xy",       "-z",  "",    "-dv+-",
                                         "-t",        "-w",  "-e",  "-aE" };

    for (int i = 0; i < N_ELEM(words); i++) {
        struct rad_params before;
        struct rad_error err = { 0 };

        rad_params_init(&p);
        rad_params_init(&before);
        ck_assert_msg(take(&p, words[i][0] ? words[i] : "x", &err) == 0,
                      "'%s' was taken", words[i]);
        ck_assert_int_eq(err.code, 0);
        ck_assert_mem_eq(&p, &before, sizeof p);
    }
}

/* as rpict -defaults has it */
TEST(no_limit_of_photons_is_taken)
{
    char option[] = "-am", most[] = "0", *argv[] = { option, most };
    struct rad_params before;

    rad_params_init(&before);
    ck_assert_int_eq(rad_params_option(&p, 1, argv, NULL), RAD_EUSAGE);
    ck_assert_int_eq(take(&p, "-am 0.0", NULL), 2);
    ck_assert_mem_eq(&p, &before, sizeof p);
}

TEST(sampling_stays_within_what_rpict_does)
{
    ck_assert_int_gt(take(&p, "-ps 0", NULL), 0);
    ck_assert_int_eq(p.psample, 1);
    ck_assert_int_gt(take(&p, "-ps 40", NULL), 0);
    ck_assert_int_eq(p.psample, 16);
}

TEST(a_negative_aspect_fills_the_picture)
{
    ck_assert_int_gt(take(&p, "-pa -1", NULL), 0);
    ck_assert(p.pixaspect == 0);
    ck_assert_int_gt(take(&p, "-pa 1.5", NULL), 0);
    ck_assert(p.pixaspect == 1.5);
}

TEST(check_refuses_what_does_not_go_together)
{
    struct rad_error err = { 0 };

    ck_assert_int_gt(take(&p, "-lr -4 -lw 0", NULL), 0);
    ck_assert_int_eq(rad_params_check(&p, &err), RAD_EUSAGE);
    ck_assert_ptr_nonnull(strstr(err.what, "-lr -4"));
}

/* -pRGB, -pXYZ and -pc: the last one counts, and Radiance's own primaries are
 * no others. */
TEST(last_kind_of_output_colour_counts)
{
    struct rad_rgb L = rad_rgb(1, 1, 1), xyz;
    char text[RAD_PARAMS_TEXT];

    rad_params_format(&p, text, sizeof text);
    ck_assert_ptr_null(strstr(text, "-pRGB"));
    ck_assert_int_gt(take(&p, "-pc .7 .3 .2 .7 .1 .1 .3 .3", NULL), 0);
    ck_assert_int_eq(p.primaries, RAD_PRIM_CUSTOM);
    ck_assert_double_eq(p.chroma[3], .7);
    ck_assert_float_eq(rad_params_colour(&p, L).r, 1);
    rad_params_format(&p, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "-pc 0.7 0.3 0.2 0.7 0.1 0.1 0.3 0.3"));
    ck_assert_int_gt(take(&p, "-pXYZ", NULL), 0);
    ck_assert_int_eq(p.primaries, RAD_PRIM_XYZ);
    ck_assert_double_eq(p.chroma[3], 0);
    /* equal-energy white has X = Y = Z, 179 lm in each watt */
    xyz = rad_params_colour(&p, L);
    ck_assert_float_eq_tol(xyz.r, 179, 1e-3f);
    ck_assert_float_eq_tol(xyz.g, 179, 1e-3f);
    ck_assert_float_eq_tol(xyz.b, 179, 1e-3f);
    ck_assert_int_gt(take(&p, "-pc .64 .33 .29 .6 .15 .06 .3333 .3333", NULL),
                     0);
    ck_assert_int_eq(p.primaries, RAD_PRIM_RGB);
}

TEST(names_of_the_last_kind_add_up)
{
    struct rad_error err = { 0 };
    char text[RAD_PARAMS_TEXT], name[10];
    int n = 0;

    ck_assert_int_gt(take(&p, "-ae r -ae blue", NULL), 0);
    ck_assert_int_eq(p.amblisted, RAD_AMB_EXCLUDE);
    ck_assert_str_eq(p.amblist, "r blue");
    rad_params_format(&p, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "-ae r -ae blue"));
    ck_assert_int_gt(take(&p, "-ai green", NULL), 0);
    ck_assert_int_eq(p.amblisted, RAD_AMB_INCLUDE);
    ck_assert_str_eq(p.amblist, "green");
    /* as many as fit: then the text does, too */
    rad_params_init(&p);
    for (;; n++) {
        char option[] = "-ai", *argv[] = { option, name };

        snprintf(name, sizeof name, "%c", 'a' + n % 26);
        if (rad_params_option(&p, 2, argv, &err) < 0)
            break;
    }
    ck_assert_int_ge(n, 390);
    ck_assert_ptr_nonnull(strstr(err.what, "more than"));
    p.pixjitter = p.maxdiff = p.shadthresh = 1 / 3. * 1e-300;
    rad_params_format(&p, text, sizeof text);
    ck_assert_uint_lt(strlen(text), sizeof text - 1);
    struct rad_params q;

    rad_params_init(&q);
    ck_assert_int_gt(take(&q, text, NULL), 0);
    ck_assert_mem_eq(&p, &q, sizeof p);
}

static double
any_real(uint64_t key)
{
    double u = rad_rand(key, 0);

    /* short ones, long ones, and every size */
    return key % 3 == 0 ? floor(u * 100) / 100 : ldexp(u, (int)(key % 400));
}

TEST(text_gives_the_same_parameters_bit_for_bit)
{
    for (uint64_t i = 0; i < 300; i++) {
        struct rad_params q;
        char text[RAD_PARAMS_TEXT], again[RAD_PARAMS_TEXT];

        rad_params_init(&p);
        p.maxdiff = any_real(7 * i);
        p.shadthresh = any_real(7 * i + 1);
        p.minweight = 1 / (1 + any_real(7 * i + 2));
        p.ambval = rad_rgb((float)rad_rand(i, 1), 1e-38f, 3e38f);
        p.seed = rad_mix64(i);
        p.maxdepth = -(int)(i % 9);
        p.directvis = i & 1;
        p.irradiance = i & 2;
        rad_params_format(&p, text, sizeof text);
        rad_params_init(&q);
        q.directvis = !p.directvis;
        ck_assert_int_gt(take(&q, text, NULL), 0);
        ck_assert_mem_eq(&p, &q, sizeof p);
        rad_params_format(&q, again, sizeof again);
        ck_assert_str_eq(text, again);
    }
}

static const struct {
    const char *a, *b, *name;
} differing[] = {
    { "-ab 1 -ad 64 --seed=0", "-ab 1 -ad 65 --seed=0", "-ad" },
    { "-ab 1 -av 0 -.5 0 --seed=0", "-ab 1 -av 0 -.6 0 --seed=0", "-av" },
    { "-ab 1 --seed=0", "-ab 1 --seed=12", "--seed" },
    { "-ab 1 --seed=0 -cs 6", "-ab 1 --seed=0", "-cs" },
    { "-ab 1 --seed=0", "-ab 1 --seed=0 -cs 6", "-cs" },
    { "-ab 1 -cs 6 --seed=0", "-ab 1 --seed=0", "-cs" },
    { "-ab 1 --seed=0", "-ab 1 -cs 6 --seed=0", "-cs" },
    { "-ab 2 -cs 6", "-ab 1", "-ab" },
};

LOOP_TEST(first_option_that_differs_is_named, N_ELEM(differing))
{
    int n;
    const char *name = rad_params_differ(differing[_i].a, differing[_i].b, &n);

    ck_assert_int_eq(n, (int)strlen(differing[_i].name));
    ck_assert_mem_eq(name, differing[_i].name, (size_t)n);
}

TEST(records_of_colours_know_no_bands_nor_places)
{
    struct rad_params q, r;

    q = p;
    q.bands = (struct rad_bands){ 20, 700, 400, RAD_PLANE_COLOURS };
    q.shown[0] = q.shown[3] = 4;
    rad_params_of_records(&q, &r);
    ck_assert_mem_eq(&r, &p, sizeof p);
    q.bands.plane = 0;
    rad_params_of_records(&q, &r);
    ck_assert_int_eq(r.bands.n, 20);
}

TEST(longest_text_fits)
{
    char text[RAD_PARAMS_TEXT];
    struct rad_rgb longest = rad_grey(1.17549446e-38f);

    p.xres = p.yres = RAD_MAX_RES;
    p.pixaspect = p.pixjitter = p.maxdiff = p.srcjitter = p.srcsizerat =
        p.shadthresh = p.shadcert = p.specjitter = p.specthresh = p.seccg =
            p.ssampdist = p.ambacc = p.minweight = 1.2345678901234567e-300;
    p.cextinction = p.salbedo = p.ambval = longest;
    p.vspretest = p.ambvwt = p.ambres = 2147483647;
    p.maxdepth = -30000;
    p.seed = UINT64_MAX;
    rad_params_format(&p, text, sizeof text);
    ck_assert_uint_lt(strlen(text), sizeof text - 1);
    ck_assert_ptr_nonnull(strstr(text, "--seed=18446744073709551615"));
}

static void
take_line(void *arg, const char *text)
{
    struct rad_params taken;
    char copy[256];

    strcpy(copy, text);
    ck_assert_ptr_nonnull(strchr(copy, '#'));
    *strchr(copy, '#') = '\0';
    rad_params_init(&taken);
    ck_assert_msg(take(&taken, copy, NULL) > 0, "'%s'", text);
    ++*(int *)arg;
}

TEST(every_line_of_the_defaults_is_an_option)
{
    int n = 0;

    rad_params_print_defaults(&p, take_line, &n);
    ck_assert_int_gt(n, 30);
}

/* radsubmit(1) as text. */
static char *
manual(void)
{
    const char *top = getenv("top_srcdir");
    char path[4096];
    size_t n;

    snprintf(path, sizeof path, "%s/man/radsubmit.1", top ? top : ".");
    return (char *)rad_file_read(path, 1 << 20, &n, NULL);
}

static void
look_up(void *arg, const char *text)
{
    char name[32], item[64];

    ck_assert_int_eq(sscanf(text, "-%31[-a-zA-Z]", name), 1);
    if (strchr("+-", name[strlen(name) - 1]))
        name[strlen(name) - 1] = '\0'; /* -dv- */
    snprintf(item, sizeof item, ".It Fl %s%s", name[0] == '-' ? "\\" : "",
             name);
    ck_assert_msg(strstr(arg, item) != NULL, "no '%s' in radsubmit(1)", item);
}

TEST(every_option_is_in_the_manual)
{
    char *page = manual();

    ck_assert_msg(page != NULL, "top_srcdir must say where man/ is");
    rad_params_print_defaults(&p, look_up, page);
    free(page);
}

TEST(reals_are_written_as_short_as_can_be)
{
    static const struct {
        double value;
        const char *text;
    } row[] = { { .1, "0.1" },
                { 0, "0" },
                { -.05, "-0.05" },
                { 1e-4, "0.0001" },
                { 100, "100" },
                { -0., "-0" },
                { 1e300, "1e+300" },
                { 1. / 3, "0.3333333333333333" },
                { .1 + .2, "0.30000000000000004" } };
    char buf[RAD_NUMBER_TEXT];

    for (int i = 0; i < N_ELEM(row); i++) {
        rad_format_real(buf, row[i].value);
        ck_assert_str_eq(buf, row[i].text);
    }
    rad_format_float(buf, .1f);
    ck_assert_str_eq(buf, "0.1");
}

/* A number as text: 1 to 20 digits, a point or none, an exponent or none. */
static void
any_number(uint64_t key, char text[64])
{
    int digits = 1 + (int)(rad_mix64(key) % 20), n = 0;
    int point = (int)(rad_mix64(key + 1) % 22) - 1;

    if (rad_mix64(key + 2) % 3 == 0)
        text[n++] = rad_mix64(key + 2) & 8 ? '-' : '+';
    for (int i = 0; i < digits; i++) {
        if (i == point)
            text[n++] = '.';
        text[n++] = (char)('0' + rad_mix64(key + 10 + (uint64_t)i) % 10);
    }
    text[n] = '\0';
    if (rad_mix64(key + 3) % 2)
        sprintf(text + n, "e%d", (int)(rad_mix64(key + 4) % 700) - 360);
}

TEST(reals_are_read_as_strtod_reads_them)
{
    for (uint64_t i = 0; i < 100000; i++) {
        double truth, v = 0, taken = 0;
        char text[64], *end;
        const char *past;

        any_number(100 * i, text);
        truth = strtod(text, &end);
        ck_assert_int_eq(*end, '\0');
        ck_assert_msg(rad_read_real(text, &v), "%s", text);
        ck_assert_msg(memcmp(&v, &truth, sizeof v) == 0, "%s", text);
        strcpy(end, " 7");
        past = rad_take_real(text, &taken);
        if (past && past == end)
            ck_assert_msg(memcmp(&taken, &truth, sizeof v) == 0, "%s", text);
        else /* too long a number, or one with an exponent */
            ck_assert_msg(strchr(text, 'e') || end - text >= 16, "%s", text);
    }
}

TEST(text_that_is_no_number_is_not_read)
{
    static const char *const text[] = { "",    ".",   "-",    "+-1",   "e5",
                                        "1e",  "1e+", "1e5.", "1.2.3", "0x10",
                                        "nan", "inf", " 1",   "1 " };
    double v;

    for (int i = 0; i < N_ELEM(text); i++)
        ck_assert_msg(!rad_read_real(text[i], &v), "%s", text[i]);
    ck_assert_ptr_null(rad_take_real("-. ", &v));
}
