/* submit_parse.c - see submit_parse.h
 *
 * Each word is offered in turn to the table of submit_table.c, to the options
 * of sensor points, to the renderer's and to the view's; the first that knows
 * the option takes its words and returns how many. */
#include "config.h"

#include "job/submit_parse.h"
#include "job/quality.h"
#include "job/submit_check.h"
#include "job/submit_table.h"
#include "records/amblist.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The state of the parser. */
struct cursor {
    struct submit_options *o;
    struct words *w;
    int at;
    quality_given given; /* options that --quality must not set */
    struct rad_error *err;
};
/* -vf FILE */
static int
take_view_file(struct cursor *c)
{
    enum { LONGEST = 1 << 20 };
    const char *path = c->w->list[c->at + 1];
    char *text;
    size_t n;
    FILE *f;
    int rc;

    if (strcmp(c->w->list[c->at], "-vf") != 0)
        return 0;
    if (!path)
        return rad_fail(c->err, RAD_EUSAGE, "option '-vf': missing value");
    f = fopen(path, "r");
    text = malloc(LONGEST);
    if (!f || !text) {
        rc = rad_fail(c->err, f ? RAD_ENOMEM : RAD_ENOINPUT,
                      "cannot open view file '%s': %s", path, strerror(errno));
    } else {
        n = fread(text, 1, LONGEST, f);
        rc = ferror(f)
                 ? rad_fail(c->err, RAD_ENOINPUT,
                            "cannot read the view file: %s", strerror(errno))
                 : inputs_add_fd(&c->w->inputs, "the view file", fileno(f),
                                 c->err);
        if (rc == 0)
            rc = rad_view_read(&c->o->view, text, n, c->err);
        if (rc == 0)
            rc = rad_fail(c->err, RAD_EDATA, "no view in the file");
        if (rc < 0)
            rad_error_where(c->err, "%s", path);
    }
    if (f)
        fclose(f);
    free(text);
    return rc < 0 ? rc : 2;
}

/* -w, -w+, -w-: warnings; they are on at first. */
static int
take_warnings(struct cursor *c)
{
    bool on = !c->o->quiet;

    if (!rad_params_switch(c->w->list[c->at], "-w", &on))
        return 0;
    c->o->quiet = !on;
    return 1;
}

/* -co, -co+, -co-: spectra instead of colours. */
static int
take_spectral(struct cursor *c)
{
    bool on = c->o->spectral == 1;

    if (!rad_params_switch(c->w->list[c->at], "-co", &on))
        return 0;
    c->o->spectral = on;
    return 1;
}

static int
is_wish(const char *word)
{
    if (strcmp(word, "--help") == 0 || strcmp(word, "-help") == 0)
        return SUBMIT_HELP;
    if (strcmp(word, "--version") == 0 || strcmp(word, "-version") == 0)
        return SUBMIT_VERSION;
    if (strcmp(word, "--rpict-path") == 0)
        return SUBMIT_RPICT;
    if (strcmp(word, "-defaults") == 0)
        return SUBMIT_DEFAULTS;
    return SUBMIT_RUN;
}

/* An option of the renderer's. */
static int
take_params(struct cursor *c, int argc, char *const argv[])
{
    int rc = rad_params_option(&c->o->params, argc, argv, c->err);

    if (rc > 0 && strncmp(argv[0], "-p", 2) == 0 &&
        islower((unsigned char)argv[0][2]) && strcmp(argv[0], "-pc") != 0 &&
        !c->o->for_pixels)
        c->o->for_pixels = argv[0];
    if (rc > 0 && strcmp(argv[0], "-pRGB") == 0 && c->o->spectral == 1)
        c->o->spectral = 0;
    if (rc > 0 && strcmp(argv[0], "-ps") == 0)
        c->o->psample_asked = (int)strtol(argv[1], NULL, 10);
    if (rc > 0)
        c->given |= quality_bit(argv[0]);
    return rc;
}

/* -aE, -aI */
static int
take_name_list(struct cursor *c, int argc, char *const argv[])
{
    int rc = amblist_option(&c->o->params, argc, argv, c->err);
    int noted = rc > 1 ? inputs_add(&c->w->inputs, "a list of modifiers",
                                    argv[1], c->err)
                       : 0;

    return noted < 0 ? noted : rc;
}

static int
take_any(struct cursor *c)
{
    char *const *argv = c->w->list + c->at;
    int argc = c->w->n - c->at, rc;

    if ((rc = take_warnings(c)) != 0 || (rc = take_spectral(c)) != 0 ||
        (rc = take_name_list(c, argc, argv)) != 0)
        return rc;
    if ((rc = take_view_file(c)) != 0) {
        c->o->for_pixels = argv[0];
        return rc;
    }
    if ((rc = submit_table_take(c->o, argv, c->err)) != 0 ||
        (rc = pointspec_option(&c->o->points, argc, argv, c->err)) != 0 ||
        (rc = take_params(c, argc, argv)) != 0)
        return rc;
    if ((rc = rad_view_option(&c->o->view, argc, argv, c->err)) != 0) {
        c->o->for_pixels = argv[0];
        return rc;
    }
    if (strcmp(argv[0], "-features") == 0)
        return rad_fail(c->err, RAD_EUSAGE,
                        "option '-features': an option of rpict that is not "
                        "supported");
    return rad_fail(c->err, RAD_EUSAGE,
                    "unknown option '%s'; see radsubmit --help", argv[0]);
}

static int
take_option(struct cursor *c)
{
    const struct rad_params *p = &c->o->params;
    int listed = p->amblisted, rc = take_any(c);

    if (listed != 0 && p->amblisted != listed)
        c->o->names_dropped = true;
    return rc;
}

/* Take all options before the first scene.  Returns an enum submit_wish. */
static int
take_options(struct cursor *c)
{
    int wish = SUBMIT_RUN, rc;

    for (;;) {
        const char *word;

        if ((rc = words_expand(c->w, c->at, c->err)) < 0)
            return rc;
        word = c->w->list[c->at];
        if (!word || word[0] != '-' || word[1] == '\0')
            return wish;
        if (strcmp(word, "--") == 0) {
            c->at++;
            return wish;
        }
        rc = is_wish(word);
        if (rc == SUBMIT_HELP || rc == SUBMIT_VERSION || rc == SUBMIT_RPICT)
            return rc;
        if (rc == SUBMIT_DEFAULTS) {
            wish = rc;
            c->at++;
            continue;
        }
        if ((rc = take_option(c)) < 0)
            return rc;
        c->at += rc;
    }
}

static int
take_scenes(struct cursor *c, bool dashes)
{
    int nstdin = 0;

    c->o->scenes = c->w->list + c->at;
    c->o->nscenes = c->w->n - c->at;
    if (c->o->nscenes == 0)
        return rad_fail(c->err, RAD_EUSAGE,
                        "no scene given; see radsubmit --help");
    for (int i = 0; i < c->o->nscenes; i++) {
        const char *word = c->o->scenes[i];

        if (strcmp(word, "-") == 0)
            nstdin++;
        else if (word[0] == '-' && !dashes)
            return rad_fail(c->err, RAD_EUSAGE,
                            "option '%s' after scene '%s': options come first",
                            word, c->o->scenes[0]);
    }
    if (nstdin > 1)
        return rad_fail(c->err, RAD_EUSAGE, "standard input given twice");
    if (nstdin && c->o->first_frame && !c->o->views)
        return rad_fail(c->err, RAD_EUSAGE,
                        "standard input cannot hold both scene and views: "
                        "use --views");
    return 0;
}

int
submit_parse(struct submit_options *o, struct words *w, struct rad_error *err)
{
    struct cursor c = { .o = o, .w = w, .err = err };
    int rc;

    submit_options_init(o);
    rc = take_options(&c);
    if (rc >= 0 && o->points.file) { /* again, with rtrace's defaults */
        submit_options_init(o);
        pointspec_defaults(&o->params);
        c = (struct cursor){ .o = o, .w = w, .err = err };
        rc = take_options(&c);
    }
    if (rc >= 0 && o->quality < 0 && c.given == 0 && submit_options_goal(o)) {
        int bad = quality_first(&o->params, err);

        rc = bad < 0 ? bad : rc;
    }
    if (rc >= 0 && o->quality >= 0) {
        int bad = quality_apply(o->quality, c.given, &o->params, err);

        o->quality_whole = c.given == 0 && o->oversample == 0;

        rc = bad < 0 ? bad : rc;
    }
    o->ambres_given = (c.given & quality_bit("-ar")) != 0;
    if (rc != SUBMIT_RUN)
        return rc;
    rc = take_scenes(&c, c.at > 0 && strcmp(w->list[c.at - 1], "--") == 0);
    if (rc == 0)
        rc = submit_check(o, err);
    return rc < 0 ? rc : SUBMIT_RUN;
}
