/* check_options.c - radsubmit's command line */
#include "config.h"

#include "job/submit_options.h"
#include "job/submit_pairs.h"
#include "job/submit_parse.h"
#include "common/words.h"
#include "tests/scratch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

/* The command line that was parsed last, and what it comes to. */
static struct words w;
static struct submit_options o;
static struct rad_error err;

static void
tear_down(void)
{
    words_release(&w);
    scratch_remove();
}

FIXTURE(scratch_make, tear_down)

/* Cut a command line at its blanks (those of `line`, which is changed). */
static int
split(char *line, char *argv[], int room)
{
    int argc = 0;
    char *save;

    argv[argc++] = (char *)"radsubmit";
    for (char *word = strtok_r(line, " ", &save); word && argc < room - 1;
         word = strtok_r(NULL, " ", &save))
        argv[argc++] = word;
    argv[argc] = NULL;
    return argc;
}

static int
parse(const char *text)
{
    static char line[1000];
    char *argv[100];
    int argc;

    snprintf(line, sizeof line, "%s", text);
    argc = split(line, argv, N_ELEM(argv));
    words_release(&w);
    err = (struct rad_error){ 0 };
    ck_assert_int_eq(words_init(&w, argc, argv, &err), 0);
    return submit_parse(&o, &w, &err);
}

TEST(options_of_both_kinds_mix)
{
    int rc =
        parse("-ab 2 --workers=3 -x 384 --threads 2 -vp 1 2 3 -dv- "
              "--partition=window --order random --windows=64 -o a.hdr "
              "--no-share --same-bits -z d.z --seed=7 --wait 2.5 a.rad b.rad");

    ck_assert_msg(rc == SUBMIT_RUN, "%s", err.what);
    ck_assert_int_eq(o.params.ambounce, 2);
    ck_assert_int_eq(o.params.xres, 384);
    ck_assert_int_eq(o.params.yres, 512);
    ck_assert(!o.params.directvis);
    ck_assert_uint_eq(o.params.seed, 7);
    ck_assert_double_eq(o.view.vp[1], 2);
    ck_assert_int_eq(o.workers, 3);
    ck_assert_int_eq(o.threads, 2);
    ck_assert_int_eq(o.partition, MSG_PART_WINDOW);
    ck_assert_int_eq(o.order, MSG_ORDER_RANDOM);
    ck_assert_int_eq(o.windows, 64);
    ck_assert_double_eq(o.wait_s, 2.5);
    ck_assert(o.no_share);
    ck_assert(o.same_bits);
    ck_assert_str_eq(o.output, "a.hdr");
    ck_assert_str_eq(o.depth, "d.z");
    ck_assert_int_eq(o.nscenes, 2);
    ck_assert_str_eq(o.scenes[1], "b.rad");
}

/* The rendering options that a command line comes to. */
static const char *
params_of(const char *text)
{
    static char formatted[2][RAD_PARAMS_TEXT];
    static int turn;

    ck_assert_int_eq(parse(text), SUBMIT_RUN);
    turn = !turn;
    rad_params_format(&o.params, formatted[turn], RAD_PARAMS_TEXT);
    return formatted[turn];
}

TEST(a_dash_is_standard_output)
{
    ck_assert_int_eq(parse("-o - a.rad"), SUBMIT_RUN);
    ck_assert_ptr_null(o.output);
    ck_assert_int_eq(parse("-S 1 -o - a.rad"), SUBMIT_RUN);
    ck_assert_ptr_null(o.output);
    ck_assert_int_eq(parse("-o ./- a.rad"), SUBMIT_RUN);
    ck_assert_str_eq(o.output, "./-");
}

TEST(quality_is_for_what_was_not_said)
{
    const char *plain = "-vp 0 0 0 -aa .3 s.rad";

    ck_assert_str_eq(params_of("--quality=high -aa .7 -ps 2 s.rad"),
                     params_of("-aa .7 -ps 2 --quality=high s.rad"));
    ck_assert_str_ne(params_of("--quality=high -aa .7 s.rad"),
                     params_of("--quality=high s.rad"));
    ck_assert_str_ne(params_of("--quality=high s.rad"),
                     params_of("--quality=medium s.rad"));
    /* of several the last; what a default says counts too */
    ck_assert_str_eq(params_of("--quality=draft --quality=high s.rad"),
                     params_of("--quality=high s.rad"));
    ck_assert_ptr_nonnull(
        strstr(params_of("-ab 0 --quality=high s.rad"), "-ab 0 "));
    ck_assert_ptr_nonnull(strstr(params_of(plain), "-aa 0.3 "));
}

LOOP_TEST(samples_go_by_quality_or_by_what_the_picture_is_for, 12)
{
    static const struct {
        const char *line;
        int oversample;
    } rows[] = { { "a.rad", 1 },
                 { "-o x.hdr a.rad", 1 },
                 { "-o x.png a.rad", 2 },
                 { "--format=png a.rad", 2 },
                 { "-o x.png --format=hdr a.rad", 1 },
                 { "-o x.png --oversample=1 a.rad", 1 },
                 { "-o x.hdr --preview=x.png a.rad", 1 },
                 { "--quality=draft -o x.png a.rad", 1 },
                 { "--quality=low a.rad", 2 },
                 { "--quality=medium a.rad", 2 },
                 { "--quality=high a.rad", 3 },
                 { "--oversample=4 --quality=high a.rad", 4 } };

    ck_assert_int_eq(parse(rows[_i].line), SUBMIT_RUN);
    ck_assert_int_eq(o.oversample, rows[_i].oversample);
    ck_assert_int_eq(o.params.xres, 512 * rows[_i].oversample);
}

TEST(options_about_messages_are_rpicts)
{
    static const struct {
        const char *line;
        bool quiet;
    } say[] = { { "a.rad", false },
                { "-w a.rad", true },
                { "-w -w a.rad", false },
                { "-w- a.rad", true },
                { "-w -w+ a.rad", false } };

    for (int i = 0; i < N_ELEM(say); i++) {
        ck_assert_int_eq(parse(say[i].line), SUBMIT_RUN);
        ck_assert_int_eq(o.quiet, say[i].quiet);
    }
    ck_assert_int_eq(parse("-t 30 -e err.txt a.rad"), SUBMIT_RUN);
    ck_assert_int_eq(o.report_s, 30);
    ck_assert_str_eq(o.errors, "err.txt");
}

TEST(names_of_modifiers_come_from_files)
{
    char path[] = "/tmp/check_options.XXXXXX", line[200];
    int fd = mkstemp(path);

    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(write(fd, " red\n\tblue green ", 17), 17);
    close(fd);
    snprintf(line, sizeof line, "-ae white -aE %s a.rad", path);
    ck_assert_int_eq(parse(line), SUBMIT_RUN);
    ck_assert_int_eq(o.params.amblisted, RAD_AMB_EXCLUDE);
    ck_assert_str_eq(o.params.amblist, "white red blue green");
    snprintf(line, sizeof line, "-ae white -aI %s a.rad", path);
    ck_assert_int_eq(parse(line), SUBMIT_RUN);
    ck_assert_int_eq(o.params.amblisted, RAD_AMB_INCLUDE);
    ck_assert_str_eq(o.params.amblist, "red blue green");
    unlink(path);
}

static const struct {
    const char *line;
    int partition, order;
    const char *estimate, *costs;
    bool no_balance;
} sharing[] = {
    { "a.rad", PARTITION_NONE, ORDER_NONE, NULL, NULL, false },
    { "--partition=static --estimate=20a a.rad", MSG_PART_STATIC, ORDER_NONE,
      "20a", NULL, false },
    { "--partition static --no-balance --estimate 1000b a.rad", MSG_PART_STATIC,
      ORDER_NONE, "1000b", NULL, true },
    { "--partition=scanbar --estimate=uniform a.rad", MSG_PART_SCANBAR,
      ORDER_NONE, "uniform", NULL, false },
    { "--partition=window --order=cost --estimate=1a a.rad", MSG_PART_WINDOW,
      MSG_ORDER_COST, "1a", NULL, false },
    { "--order=forward a.rad", PARTITION_NONE, MSG_ORDER_FORWARD, NULL, NULL,
      false },
    { "--order=backward a.rad", PARTITION_NONE, MSG_ORDER_BACKWARD, NULL, NULL,
      false },
    { "--estimate=b/20a.json a.rad", PARTITION_NONE, ORDER_NONE, NULL,
      "b/20a.json", false },
};

LOOP_TEST(work_is_shared_as_asked, N_ELEM(sharing))
{
    ck_assert_msg(parse(sharing[_i].line) == SUBMIT_RUN, "%s", err.what);
    ck_assert_int_eq(o.partition, sharing[_i].partition);
    ck_assert_int_eq(o.order, sharing[_i].order);
    ck_assert_pstr_eq(o.estimate, sharing[_i].estimate);
    ck_assert_pstr_eq(o.costs, sharing[_i].costs);
    ck_assert_int_eq(o.no_balance, sharing[_i].no_balance);
}

static const struct {
    const char *line;
    const char *names; /* must be in the message */
} wrong[] = {
    { "-x abc a.rad", "-x" },
    { "-x", "-x" },
    { "-x -3 a.rad", "-x" },
    { "-r f a.rad", "-r" },
    { "-e x=3 a.rad", "-e" },
    { "-t -1 a.rad", "-t" },
    { "-pm .1 -S 2 -o %d.hdr a.rad", "-S" },
    { "-aI", "-aI" },
    { "-af", "-af" },
    { "-features a.rad", "'-features': an option of rpict that is not" },
    { "-fc --points=p a.rad", "unknown option '-fc'" },
    { "-faac --points=p a.rad", "unknown option '-faac'" },
    { "-nonsense a.rad", "-nonsense" },
    { "--nonsense a.rad", "--nonsense" },
    { "--partition=pie a.rad", "pie" },
    { "--partition=scanbar --windows=4 a.rad", "--windows" },
    { "--order=cost --partition=static a.rad", "--order" },
    { "--order=dear a.rad", "dear" },
    { "--estimate=5c a.rad", "5c" },
    { "--estimate=a a.rad", "--estimate" },
    { "--estimate=0b a.rad", "--estimate" },
    { "--estimate=1001a a.rad", "1000" },
    { "--estimate=9999999999a a.rad", "--estimate" },
    { "--estimate=20ab a.rad", "20ab" },
    { "--estimate=-5a a.rad", "--estimate" },
    { "--estimate=stats.txt a.rad", "FILE.json" },
    { "--estimate=.json a.rad", "FILE.json" },
    { "--no-balance=1 a.rad", "--no-balance" },
    { "--no-balance a.rad", "--partition=static" },
    { "--no-balance --partition=scanbar a.rad", "--partition=static" },
    { "--stamp -o a.png a.rad", "--stamp" },
    { "--stamp --format=png a.rad", "--stamp" },
    { "--workers=0 a.rad", "--workers" },
    { "--workers=2.5 a.rad", "--workers" },
    { "--workers=65 a.rad", "at most 64 on one machine" },
    { "--workers", "--workers" },
    { "--threads= a.rad", "--threads" },
    { "--wait=-1 a.rad", "--wait" },
    { "--wait=nan a.rad", "--wait" },
    { "--local=yes a.rad", "--local" },
    { "--local --coordinator=h:1 a.rad", "--coordinator" },
    { "--reuse= a.rad", "--reuse" },
    { "--reuse=latest a.rad", "--reuse" },
    { "--reuse=0123456789abcdef a.rad", "--reuse" },
    { "--reuse=last --ambient=live a.rad", "--ambient=live" },
    { "--reuse=last --no-share a.rad", "--no-share" },
    { "--reuse=last --fresh-frames -S 1 a.rad", "--fresh-frames" },
    { "--reuse=last --dry-run a.rad", "--dry-run" },
    { "--reuse=last --local a.rad", "coordinator" },
    { "--views=v a.rad", "--views" },
    { "--no-clobber -o a%d.hdr a.rad", "--no-clobber" },
    { "--no-clobber -S 1 a.rad", "--no-clobber" },
    { "--no-clobber -S 1 --views=v -o - a.rad", "--no-clobber" },
    { "--view a.rad", "scene" },
    { "-S 0 -o %d.hdr a.rad", "-S" },
    { "-S 1 -o %d.hdr -", "--views" },
    { "--detach -o a.hdr a.rad", "--detach" },
    { "--detach -cs 6 -pXYZ a.rad", "-pXYZ" },
    { "-vu 0 1 0 a.rad", "" }, /* parallel to the direction */
    { "-vf", "-vf" },
    { "a.rad -x 3", "'-x' after scene 'a.rad': options come first" },
    { "- -", "standard input" },
    { "", "scene" },
    { "-ab 0", "scene" },
};

LOOP_TEST(wrong_command_lines_are_named, N_ELEM(wrong))
{
    ck_assert_int_eq(parse(wrong[_i].line), RAD_EUSAGE);
    ck_assert_int_eq(rad_exit_status(err.code), EX_USAGE);
    ck_assert_msg(strstr(err.what, wrong[_i].names), "'%s' does not name '%s'",
                  err.what, wrong[_i].names);
}

/* Options with what each needs, and those that it does not go with.  A pair
 * stands in the row of either. */
static const struct {
    const char *name, *words, *against;
} together[] = {
    { "--detach", "--detach",
      "-o -z --stats --preview --tone --exposure --bits --false-colour "
      "--no-clobber --dry-run --job" },
    { "--dry-run", "--dry-run", "--error --time --reuse --reuse=last --job" },
    { "--points", "--points=p",
      "-vp -S --views --no-clobber --fresh-frames -z --format --preview "
      "--oversample --clamp --tone --exposure --bits --false-colour --view "
      "-pc" },
    { "--job", "--job=0123456789abcdef0123456789abcdef --points=p",
      "-vp -S --views --no-clobber --fresh-frames -z --format --preview "
      "--oversample --clamp --tone --exposure --bits --false-colour --view "
      "-cs -pc" },
    { "-cs", "-cs 6", "-pc" },
    { "--error", "--error=5 -ab 1", "-af --ambient=live --no-share" },
    { "--time", "--time=9 -ab 1", "-af --ambient=live --no-share" },
    { "--reuse", "--reuse=0123456789abcdef0123456789abcdef",
      "--ambient=live --no-share --fresh-frames --local --launch --address" },
    { "--reuse=last", "--reuse=last",
      "--ambient=live --no-share --fresh-frames --local --launch --address" },
    { "--fresh-frames", "--fresh-frames -S 1",
      "--ambient=passes --error --time" },
    { "--no-share", "--no-share", "--ambient=passes" },
    { "--partition=auto", "--partition=auto", "--windows --order" },
    { "--partition=static", "--partition=static", "--windows --order" },
    { "--partition=scanbar", "--partition=scanbar", "--windows --order" },
    { "--partition=window", "--partition=window", "" },
    { "--local", "--local", "--launch --address --coordinator" },
    { "--launch", "--launch=srun --workers=65", "--coordinator" },
    { "--address", "--address=h --launch=srun", "--coordinator" },
    { "--coordinator", "--coordinator=h:1", "" },
    { "--format", "--format=png", "" },
    { "--false-colour", "--false-colour --format=png",
      "--tone --exposure --bits" },
    { "--tone", "--tone=linear --format=png", "" },
    { "--exposure", "--exposure=+1 --format=png", "" },
    { "--bits", "--bits=16 --format=png", "" },
    { "--preview", "--preview=p.png", "" },
    { "--clamp", "--clamp=4 --oversample=2", "" },
    { "--oversample", "--oversample=2", "" },
    { "--views", "--views=v -S 1", "" },
    { "--view", "--view=v", "" },
    { "--no-clobber", "--no-clobber -S 1 -o a%d.png", "" },
    { "-S", "-S 1", "" },
    { "-vp", "-vp 1 2 3", "" },
    { "-o", "-o a.hdr", "" },
    { "-z", "-z a.z", "" },
    { "-af", "-af a.amb", "" },
    { "-pc", "-pc .7 .3 .2 .7 .1 .1 .3 .3", "" },
    { "--stats", "--stats=s.json", "" },
    { "--windows", "--windows=4", "" },
    { "--order", "--order=cost", "" },
    { "--estimate", "--estimate=s.json", "" },
    { "--ambient=live", "--ambient=live", "" },
    { "--ambient=passes", "--ambient=passes", "" },
};

/* Is `name` a word of `list`? */
static bool
has_word(const char *list, const char *name)
{
    size_t n = strlen(name);

    for (const char *at = list; (at = strstr(at, name)) != NULL; at += n)
        if ((at == list || at[-1] == ' ') && strchr(" ", at[n]))
            return true;
    return false;
}

LOOP_TEST(each_pair_goes_together_or_is_named, N_ELEM(together))
{
    for (size_t j = 0; j < N_ELEM(together); j++) {
        bool refused = has_word(together[_i].against, together[j].name) ||
                       has_word(together[j].against, together[_i].name);
        char line[300];
        int rc;

        snprintf(line, sizeof line, "%s %s a.rad", together[_i].words,
                 together[j].words);
        rc = parse(line);
        if (!refused)
            ck_assert_msg(rc == SUBMIT_RUN, "%s: %s", line, err.what);
        else
            ck_assert_msg(rc == RAD_EUSAGE && strchr(err.what, '-'),
                          "%s is taken (%d), or told as '%s'", line, rc,
                          err.what);
    }
}

/* Of a scene with spectra, which the command line alone does not tell. */
static const struct {
    const char *words;
    bool refused;
} planes[] = {
    { "", false },
    { "--reuse=last -ab 1", false },
    { "-o a.hdr -z a.z --stats=s.json", false },
    { "--error=5 -ab 1", true },
    { "--time=9 -ab 1", true },
    { "--preview=p.png", true },
    { "-af a.amb", true },
    { "--estimate=s.json", true },
    { "--reuse=0123456789abcdef0123456789abcdef -ab 1", true },
};

LOOP_TEST(each_three_bands_are_a_job_of_their_own, N_ELEM(planes))
{
    char line[200];

    snprintf(line, sizeof line, "-cs 6 %s a.rad", planes[_i].words);
    ck_assert_int_eq(parse(line), SUBMIT_RUN);
    ck_assert_int_eq(submit_pairs_check(&o, true, &err),
                     planes[_i].refused ? RAD_EUSAGE : 0);
    if (planes[_i].refused)
        ck_assert_msg(strstr(err.what, "-cs above 3 and -") == err.what, "%s",
                      err.what);
}

static const struct {
    const char *words;
    int spectral;
} last[] = {
    { "-cs 6", -1 },
    { "-cs 6 -co", 1 },
    { "-cs 6 -co -co", 0 },
    { "-cs 6 -co+ -pRGB", 0 },
    { "-cs 6 -pRGB -co+", 1 },
    { "-cs 6 -pRGB", -1 }, /* the name's suffix decides */
};

LOOP_TEST(the_last_word_says_whether_spectra_are_written, N_ELEM(last))
{
    char line[200];

    snprintf(line, sizeof line, "%s a.rad", last[_i].words);
    ck_assert_int_eq(parse(line), SUBMIT_RUN);
    ck_assert_int_eq(o.spectral, last[_i].spectral);
}

static const struct {
    const char *kind, *line;
    const char *says[8]; /* ... among the lines of -defaults */
} printed[] = {
    { "",
      "-vp 1 2 3 -vth -x 40 -ab 2 -pXYZ --oversample=3 -t 7 -w-",
      { "-vp 1 2 3 ", "-vth ", "-x 40 ", "-ab 2 ", "-pXYZ ", "--oversample 3 ",
        "-t 7 ", "-w- " } },
    { "--points=p ",
      "-I -ovdL -fdf -x 3 -y 0 -ld+ -h- -ab 2 -pY -t 7",
      { "-I+ ", "-ovdL ", "-fdf ", "-x 3 ", "-y 0 ", "-ld+ ", "-h- ",
        "-pY " } },
};

LOOP_TEST(defaults_are_printed_as_options_are_given, N_ELEM(printed))
{
    char *text[2], line[300];

    snprintf(line, sizeof line, "%s%s -defaults", printed[_i].kind,
             printed[_i].line);
    for (int i = 0; i < 2; i++) {
        size_t len;
        FILE *to = open_memstream(&text[i], &len);

        ck_assert_int_eq(parse(line), SUBMIT_DEFAULTS);
        submit_options_defaults(&o, to);
        fclose(to);
        snprintf(line, sizeof line, "%s@%s -defaults", printed[_i].kind,
                 scratch_file("again", text[i]));
    }
    ck_assert(strcmp(text[0], text[1]) == 0);
    for (int i = 0; i < N_ELEM(printed[_i].says); i++)
        ck_assert_msg(strstr(text[0], printed[_i].says[i]), "no '%s'",
                      printed[_i].says[i]);
    free(text[0]);
    free(text[1]);
}

static const struct {
    const char *line, *text;
} point_options[] = {
    { "--points=p a.rad", "-I- -faa -ov" },
    { "--points=p -x 0 -y 5 a.rad", "-I- -faa -ov -x 0 -y 5" },
    { "--points=p -pA -y 2 -x 3 -ovdL -fdf -ld+ -I a.rad",
      "-I+ -ld+ -fdf -ovdL -x 3 -y 2 -pA" },
};

LOOP_TEST(options_of_points_are_told_in_headers, N_ELEM(point_options))
{
    char text[200];

    ck_assert_int_eq(parse(point_options[_i].line), SUBMIT_RUN);
    pointspec_format(&o.points, text, sizeof text);
    ck_assert_str_eq(text, point_options[_i].text);
}

TEST(files_and_variables_open_up_in_place)
{
    char line[600], inner[200];

    snprintf(inner, sizeof inner, "%s",
             scratch_file("inner", "\xef\xbb\xbf-ab\n 3\t-aa .1"));
    snprintf(line, sizeof line, "-x 11 @%s\n-y 12", inner);
    setenv("CHECK_OPTIONS", "-ps 2 --workers=5", 1);
    snprintf(line, sizeof line, "@%s $CHECK_OPTIONS -o @a a.rad @b",
             scratch_file("outer", line));
    ck_assert_msg(parse(line) == SUBMIT_RUN, "%s", err.what);
    ck_assert_int_eq(o.params.xres, 11);
    ck_assert_int_eq(o.params.yres, 12);
    ck_assert_int_eq(o.params.ambounce, 3);
    ck_assert_double_eq(o.params.ambacc, .1);
    ck_assert_int_eq(o.params.psample, 2);
    ck_assert_int_eq(o.psample_asked, 2);
    ck_assert_int_eq(o.workers, 5);
    ck_assert_str_eq(o.output, "@a"); /* a value is no option */
    ck_assert_int_eq(o.nscenes, 2);
    ck_assert_str_eq(o.scenes[1], "@b"); /* nor is a scene */
}

TEST(expansion_that_cannot_be_is_an_error)
{
    char line[300];

    ck_assert_int_eq(parse("@/nonexistent a.rad"), RAD_ENOINPUT);
    err.code = 0;
    ck_assert_int_eq(parse("$NO_SUCH_VARIABLE a.rad"), RAD_EUSAGE);
    err.code = 0;
    snprintf(line, sizeof line, "@%s/self", dir);
    scratch_file("self", line);
    ck_assert_int_eq(parse(line), RAD_EUSAGE);
}

TEST(view_files_are_read_in_their_place)
{
    char line[300];

    snprintf(line, sizeof line, "-vp 9 9 9 -vf %s -vh 30 a.rad",
             scratch_file("v.vf", "rvu -vp 1 2 3 -vh 60\n"));
    ck_assert_msg(parse(line) == SUBMIT_RUN, "%s", err.what);
    ck_assert_double_eq(o.view.vp[0], 1);
    ck_assert_double_eq(o.view.horiz, 30);
    ck_assert_int_eq(parse("-vf /nonexistent a.rad"), RAD_ENOINPUT);
    snprintf(line, sizeof line, "-vf %s a.rad",
             scratch_file("v.vf", "no view"));
    ck_assert_int_eq(parse(line), RAD_EDATA);
}
