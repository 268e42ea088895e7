/* check_rif.c - rad's variable files: how they read, and what rad makes of them
 *
 * Options and positions of views are what rad(1) says, worked by hand. */
#include "config.h"

#include "common/outname.h"
#include "rif/rif_view.h"
#include "tests/unit.h"

#include <stdio.h>
#include <string.h>

static struct rif r;

static void
release(void)
{
    rif_release(&r);
}

FIXTURE(NULL, release)

static void
parse(const char *text)
{
    struct rad_error err = { 0 };

    ck_assert_msg(rif_parse(&r, "x.rif", text, strlen(text), &err) == 0,
                  "%s: %s", err.where, err.what);
    ck_assert_msg(rif_check(&r, &err) == 0, "%s: %s", err.where, err.what);
}

/* --- reading --- */

static const struct {
    const char *text;
    enum rif_var v;
    const char *values; /* '|' between two */
} reads[] = {
    { "QUALITY= High\n", RIF_QUALITY, "High" },
    { "QUA=m", RIF_QUALITY, "m" },
    { "\xef\xbb\xbfQUA=m", RIF_QUALITY, "m" },
    { "  EXP =   +2.5   # bright\n", RIF_EXPOSURE, "+2.5" },
    { "EXPOSURE 3\r\n", RIF_EXPOSURE, "3" },
    { "PICTURE= a\\#b\n", RIF_PICTURE, "a#b" },
    { "scene= a.rad \\\n b.rad\nscene= c.rad", RIF_SCENE,
      "a.rad   b.rad|c.rad" },
    { "scene= a \\\r\nb\r\n", RIF_SCENE, "a  b" },
    { "# a comment \\\nscene= of two lines\nscene= a\n", RIF_SCENE, "a" },
    { "scene=\nscene= a\nscene\n\n=\n", RIF_SCENE, "a" },
    { "vi= a -vp 1 2 3\nview= b\n", RIF_VIEW, "a -vp 1 2 3|b" },
    { "ma= x\nmat= y", RIF_VARS, "x.rif:1: unknown variable 'ma'" },
    { "mat= y\n\nExp= 1", RIF_VARS, "x.rif:3: unknown variable 'Exp'" },
    { "EXPOSURES= 1", RIF_VARS, "x.rif:1: unknown variable 'EXPOSURES'" },
};

LOOP_TEST(a_line_assigns_to_its_variable, N_ELEM(reads))
{
    struct rad_error err = { 0 };
    const char *want = reads[_i].values;
    char all[200] = "";
    int rc =
        rif_parse(&r, "x.rif", reads[_i].text, strlen(reads[_i].text), &err);

    if (reads[_i].v == RIF_VARS) {
        ck_assert_int_eq(rc, RAD_EDATA);
        rad_error_format(&err, all, sizeof all);
    } else {
        ck_assert_int_eq(rc, 0);
        for (const struct rif_value *v = r.first[reads[_i].v]; v; v = v->next) {
            strcat(all, v->text);
            strcat(all, v->next ? "|" : "");
        }
    }
    ck_assert_str_eq(all, want);
}

static const struct {
    const char *text, *words; /* '|' behind each */
} words[] = {
    { "scene= a 'b c' d\"e f\"g", "a|b c|de fg|" },
    { "scene= '!gensky 7 12 17 | xform -rx -90' sky",
      "!gensky 7 12 17 | xform -rx -90|sky|" },
    { "scene= \"!xform -n a \\\n -a 9 x.rad\"\nscene= b",
      "!xform -n a   -a 9 x.rad|b|" },
    { "scene= '' a", "|a|" },
    { "scene= 'a", NULL },
    { "scene= a\nscene= b\"", NULL },
};

LOOP_TEST(words_are_parted_as_by_a_shell, N_ELEM(words))
{
    struct rad_error err = { 0 };
    char all[200] = "", **list;
    int n;

    parse(words[_i].text);
    n = rif_words(&r, RIF_SCENE, &list, &err);
    if (!words[_i].words) {
        ck_assert_int_eq(n, RAD_EDATA);
        ck_assert_str_eq(err.what, "a quote without its end");
    } else {
        for (int i = 0; i < n; i++) {
            strcat(all, list[i]);
            strcat(all, "|");
        }
        ck_assert_str_eq(all, words[_i].words);
        ck_assert_ptr_null(list[n]);
    }
}

static const struct {
    const char *text, *message;
} wrong[] = {
    { "QUALITY= best",
      "x.rif:1: QUALITY: 'best': expected low, medium or high" },
    { "\nPEN= maybe", "x.rif:2: PENUMBRAS: 'maybe': expected true or false" },
    { "IND= 1.5", "x.rif:1: INDIRECT: '1.5': expected a whole number" },
    { "EXP= bright", "x.rif:1: EXPOSURE: 'bright': expected a number" },
    { "DET= lowest",
      "x.rif:1: DETAIL: 'lowest': expected low, medium or high" },
};

LOOP_TEST(a_value_is_of_its_kind, N_ELEM(wrong))
{
    struct rad_error err = { 0 };
    char text[300];

    ck_assert_int_eq(
        rif_parse(&r, "x.rif", wrong[_i].text, strlen(wrong[_i].text), &err),
        0);
    ck_assert_int_eq(rif_check(&r, &err), RAD_EDATA);
    rad_error_format(&err, text, sizeof text);
    ck_assert_str_eq(text, wrong[_i].message);
}

TEST(the_last_value_counts_and_loses_its_quotes)
{
    parse("PIC= a\nPIC= \"b c\"\nQUAL= low\nQUAL= h\n");
    ck_assert_str_eq(rif_text(&r, RIF_PICTURE), "b c");
    ck_assert_int_eq(rif_letter(&r, RIF_QUALITY, 'L'), 'H');
    ck_assert_int_eq(rif_letter(&r, RIF_DETAIL, 'M'), 'M');
    ck_assert_int_eq(rif_assign(&r, "PIC=d", NULL), 0);
    ck_assert_str_eq(rif_text(&r, RIF_PICTURE), "d");
}

TEST(an_assignment_of_the_command_line_is_one)
{
    static const struct {
        const char *text, *message;
    } bad[] = {
        { "QUALITY", "'QUALITY' after 'x.rif': expected VARIABLE=value" },
        { "QUALITY=", "'QUALITY=' after 'x.rif': expected VARIABLE=value" },
        { "X=1", "'X=1': unknown variable 'X'" },
    };

    parse("");
    for (int i = 0; i < N_ELEM(bad); i++) {
        struct rad_error err = { 0 };

        ck_assert_int_eq(rif_assign(&r, bad[i].text, &err), RAD_EUSAGE);
        ck_assert_str_eq(err.what, bad[i].message);
    }
}

TEST(a_file_has_limits)
{
    static char text[16 * (RIF_MAX_VALUES + 1)];
    struct rad_error err = { 0 };
    size_t n = 0;

    for (int i = 0; i <= RIF_MAX_VALUES; i++)
        n += (size_t)sprintf(text + n, "view= v%d\n", i);
    ck_assert_int_eq(rif_parse(&r, "x.rif", text, n, &err), RAD_EDATA);
    ck_assert_str_eq(err.where, "x.rif:10001");
    rif_release(&r);
    err = (struct rad_error){ 0 };
    ck_assert_int_eq(rif_parse(&r, "x.rif", "a\0b", 3, &err), RAD_EDATA);
    ck_assert_str_eq(err.where, "x.rif");
}

/* --- options --- */

/* The octree's cube is 8 wide, from -2 -2 0. */
static const struct rad_octree tree = { .org = { -2, -2, 0 }, .size = 8 };

static const struct {
    const char *text, *light, *sampling;
} rules[] = {
    /* all by default: the zone is the cube, seen from outside */
    { "",
      " -dp 128 -ar 16 -ds 0 -dt .1 -dc .5 -dr 0 -ss 0 -st .5 -aa .3 -ad 256 "
      "-as 0 -av 10 10 10 -lr 6 -lw .001",
      " -ps 8 -pt .16" },
    /* the zone's mean edge is 4: 8 / 4 times 32; 4 / 40 */
    { "ZONE= I 0 4 0 6 0 2\nQUAL= Med\nIND= 2\nPEN= T\nVAR= H\nEXP= 2",
      " -dp 512 -ar 64 -ms 0.1 -ds .2 -dj .9 -dt .07 -dc .7 -dr 1 -ss 1 -st .1 "
      "-ab 2 -aa .1 -ad 1536 -as 392 -av 0.09 0.09 0.09 -lr 8 -lw 1e-4",
      " -ps 3 -pt .08" },
    { "ZONE= Interior 0 4 0 6 0 2\nQUAL= M\nDET= L",
      " -dp 256 -ar 32 -ms 0.2 -ds .3 -dt .07 -dc .7 -dr 1 -ss 1 -st .1 "
      "-aa .2 -ad 329 -as 42 -av 0.01 0.01 0.01 -lr 8 -lw 1e-4",
      " -ps 8 -pt .08" },
    { "QUAL= high\nDET= high\nVAR= med\nEXP= -1",
      " -dp 4096 -ar 128 -ms 0.05 -ds .2 -dt .04 -dc .9 -dr 3 -ss 16 -st .01 "
      "-ab 1 -aa .1 -ad 1536 -as 768 -av 0.36 0.36 0.36 -lr 12 -lw 5e-6",
      " -ps 3 -pt .04" },
    { "QUAL= h\nDET= l\nPEN= true\nIND= 3\nZONE= E 0 3 0 3 0 3",
      " -dp 1024 -ar 85 -ms 0.075 -ds .1 -dj .9 -dt .04 -dc .9 -dr 3 -ss 16 "
      "-st .01 -ab 4 -aa .125 -ad 512 -as 64 -av 10 10 10 -lr 12 -lw 5e-6",
      " -ps 1 -pt .04" },
};

LOOP_TEST(options_follow_from_the_scene, N_ELEM(rules))
{
    char light[RIF_RULES_TEXT], sampling[RIF_RULES_TEXT];
    struct rif_zone z;

    parse(rules[_i].text);
    ck_assert_int_eq(rif_zone(&r, &tree, &z, NULL), 0);
    ck_assert_int_eq(rif_rules(&r, &z, light, sampling, NULL), 0);
    ck_assert_str_eq(light, rules[_i].light);
    ck_assert_str_eq(sampling, rules[_i].sampling);
}

TEST(a_zone_has_a_volume)
{
    static const char *const bad[] = {
        "ZONE= I 0 1 0 1 0", "ZONE= I 0 1 0 1 2 2", "ZONE= Q 0 1 0 1 0 1",
        "ZONE= E 0 1 3 1 0 1", "ZONE= E 0 inf 0 1 0 1"
    };
    struct rad_octree none = { .size = 0 };
    struct rif_zone z;

    for (int i = 0; i < N_ELEM(bad); i++) {
        struct rad_error err = { 0 };

        parse(bad[i]);
        ck_assert_int_eq(rif_zone(&r, &tree, &z, &err), RAD_EDATA);
        ck_assert_str_eq(err.where, "x.rif:1");
        rif_release(&r);
    }
    parse("");
    ck_assert_int_eq(rif_zone(&r, &none, &z, NULL), RAD_EDATA);
}

/* With six digits, as rad has them from getinfo; a side that these leave
 * nothing of is the cube's. */
TEST(without_a_zone_the_octree_is_looked_at)
{
    static const struct rad_octree cube = { .org = { -1.23456789, 2, 1234567 },
                                            .size = 0.5 };
    static const double org[3] = { -1.23457, 2, 1.23457e6 };
    static const double size[3] = { -0.734568 + 1.23457, 0.5, 0.5 };
    struct rif_zone z;

    parse("");
    ck_assert_int_eq(rif_zone(&r, &cube, &z, NULL), 0);
    ck_assert(!z.interior);
    ck_assert_double_eq(z.cube, 0.5);
    for (int i = 0; i < 3; i++) {
        ck_assert_double_eq(z.org[i], org[i]);
        ck_assert_double_eq_tol(z.size[i], size[i], 1e-12);
    }
}

TEST(an_exposure_is_in_stops_or_a_factor)
{
    static const struct {
        const char *text;
        double factor;
    } rows[] = { { "", 0 },           { "EXP= +3", 8 }, { "EXP= -1", .5 },
                 { "EXP= 2.5", 2.5 }, { "EXP= 0", -1 }, { "EXP= 1e30", -1 } };
    double factor;

    for (int i = 0; i < N_ELEM(rows); i++) {
        parse(rows[i].text);
        if (rows[i].factor < 0) {
            ck_assert_int_eq(rif_exposure(&r, &factor, NULL), RAD_EDATA);
        } else {
            ck_assert_int_eq(rif_exposure(&r, &factor, NULL), 0);
            ck_assert_double_eq(factor, rows[i].factor);
        }
        rif_release(&r);
    }
}

/* --- views --- */

static const struct {
    const char *text, *which, *views; /* "name: options;" of each */
} views[] = {
    /* by default, from X; twice the zone away from its middle */
    { "", NULL, "X: -vtv -vp 18 2 4 -vd -8 0 0 -vu 0 0 1 -vh 45 -vv 45;" },
    { "ZONE= I 0 4 0 6 0 2\nview= y\nview= Zl", NULL,
      "y: -vtv -vp 2 0.3 1 -vd 0 6 0 -vu 0 0 1 -vh 45 -vv 45;"
      "Zl: -vtl -vp 2 3 1.9 -vd 0 0 -2 -vu 0 1 0 -vh 7.48 -vv 7.48;" },
    { "ZONE= E 0 4 0 6 0 2\nview= xYzc -vh 90\nUP= -Y", NULL,
      "xYzc: -vtc -vp -6 15 -3 -vd 4 -6 2 -vu 0 -1 0 -vh 180 -vv 90 -vh 90;" },
    /* what looks along the up axis takes another */
    { "ZONE= E 0 4 0 6 0 2\nUP= Y\nview= Y\nview= Xa", NULL,
      "Y: -vtv -vp 2 15 1 -vd 0 -6 0 -vu 1 0 0 -vh 45 -vv 45;"
      "Xa: -vta -vp 10 3 1 -vd -4 0 0 -vu 0 1 0 -vh 180 -vv 180;" },
    { "UP= X\nview= a -vp 1 2 3\nview= -vf b.vf", NULL,
      "a: -vu 1 0 0 -vp 1 2 3;2: -vf b.vf;" },
    { "view= a -vh 1\nview= b -vh 2", "b", "b: -vh 2;" },
    { "view= a -vh 1\nview= b -vh 2", "1", "a: -vh 1;" },
    { "view= a -vh 1", "-vh 3 -vv 4", "0: -vh 3 -vv 4;" },
    { "view= a -vh 1", "c", NULL },
    { "view= a -vh 1", "2", NULL },
    { "view= a", NULL, NULL },
    { "view= my room -vp 1 2 3", NULL, NULL },
    { "view= X from here", NULL, NULL },
    { "view= a -vh 1\nview= a -vh 2", NULL, NULL },
    { "view= 2 -vh 1\nview= -vh 2", NULL, NULL },
    { "UP= Q\nview= X", NULL, NULL },
};

LOOP_TEST(views_have_names_and_options, N_ELEM(views))
{
    struct rad_error err = { 0 };
    struct rif_view *list;
    char all[500] = "";
    struct rif_zone z;
    int n;

    parse(views[_i].text);
    ck_assert_int_eq(rif_zone(&r, &tree, &z, NULL), 0);
    n = rif_views(&r, &z, views[_i].which, &list, &err);
    if (!views[_i].views) {
        ck_assert_int_eq(n, views[_i].which ? RAD_EUSAGE : RAD_EDATA);
        ck_assert_msg(views[_i].which || strncmp(err.where, "x.rif:", 6) == 0,
                      "'%s'", err.where);
    } else {
        ck_assert_msg(n > 0, "%s", err.what);
        for (int i = 0; i < n; i++) {
            strcat(strcat(all, list[i].name), ":");
            for (int k = 0; k < list[i].nwords; k++)
                strcat(strcat(all, " "), list[i].words[k]);
            strcat(all, ";");
        }
        ck_assert_str_eq(all, views[_i].views);
    }
}

TEST(a_view_names_its_file)
{
    static const struct {
        const char *pattern;
        bool need;
        const char *name; /* NULL: refused */
    } rows[] = {
        { "pic_%s.hdr", true, "pic_east.hdr" },
        { "50%%_%s.hdr", true, "50%_east.hdr" },
        { "pic.hdr", false, "pic.hdr" },
        { "pic.hdr", true, NULL },
        { "%s%s", true, NULL },
        { "%d.hdr", true, NULL },
        { "pic%", false, NULL },
    };

    for (int i = 0; i < N_ELEM(rows); i++) {
        char *name = NULL;
        int rc =
            outname_view(&name, rows[i].pattern, "east", rows[i].need, NULL);

        if (rows[i].name)
            ck_assert_str_eq(name, rows[i].name);
        else
            ck_assert_int_eq(rc, RAD_EUSAGE);
        free(name);
    }
}
