/* rifjob.c - see rifjob.h */
#include "config.h"

#include "rif/rifjob.h"
#include "job/submit_parse.h"

#include "common/outname.h"
#include "base/output.h"
#include "rif/rif_line.h"

#include "base/files.h"
#include "base/number.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_NOTES = 32 };

/* Format a text in the arena; NULL: memory is out. */
__attribute__((format(printf, 2, 3))) static char *
format(struct rifjob *j, const char *fmt, ...)
{
    va_list args;
    char *text, *copy;
    int n;

    va_start(args, fmt);
    n = vasprintf(&text, fmt, args);
    va_end(args);
    if (n < 0)
        return NULL;
    copy = rad_arena_strndup(&j->rif.arena, text, (size_t)n);
    free(text);
    return copy;
}

/* Note a warning about a variable, for the user. */
static int
note(struct rifjob *j, enum rif_var v, const char *what, struct rad_error *err)
{
    const struct rif_value *value = j->rif.last[v];
    char *text;

    if (value && value->line > 0)
        text = format(j, "warning: %s:%d: %s: %s", j->rif.name, value->line,
                      rif_variable(v), what);
    else
        text = format(j, "warning: %s: %s: %s", j->rif.name, rif_variable(v),
                      what);
    if (!text)
        return rad_fail_memory(err);
    if (j->nnotes < MOST_NOTES)
        j->notes[j->nnotes++] = text;
    return 0;
}

static bool
is_given(const struct rifjob *j, enum rif_var v)
{
    return j->rif.last[v] != NULL;
}

/* --- the scene --- */

/* The octree that mkillum makes: "model1.oct" for "model.oct". */
static char *
illum_octree(struct rifjob *j, const char *octree)
{
    const char *slash = strrchr(octree, '/'), *dot = strrchr(octree, '.');

    if (!dot || (slash && dot < slash))
        dot = octree + strlen(octree);
    return format(j, "%.*s1%s", (int)(dot - octree), octree, dot);
}

/* The time of the newest file that the variable names; unchanged if that is
 * older. */
static int
newest(struct rifjob *j, enum rif_var v, time_t *when, struct rad_error *err)
{
    char **words;
    int n = rif_words(&j->rif, v, &words, err);

    for (int i = 0; i < n; i++) {
        struct stat st;

        if (words[i][0] != '!' && stat(words[i], &st) == 0 &&
            st.st_mtime > *when)
            *when = st.st_mtime;
    }
    return n < 0 ? n : 0;
}

static int
scene_time(struct rifjob *j, time_t *when, struct rad_error *err)
{
    static const enum rif_var of[] = { RIF_MATERIALS, RIF_SCENE, RIF_OBJECTS,
                                       RIF_ILLUM };
    int rc = 0;

    *when = 0;
    for (unsigned i = 0; i < sizeof of / sizeof of[0] && rc == 0; i++)
        rc = newest(j, of[i], when, err);
    return rc;
}

/* Make the octree the scene. */
static int
take_octree(struct rifjob *j, char *octree, struct rad_error *err)
{
    j->scenes = rad_arena_calloc(&j->rif.arena, 2, sizeof *j->scenes);
    if (!octree || !j->scenes)
        return rad_fail_memory(err);
    j->scenes[0] = octree;
    j->nscenes = 1;
    return 0;
}

/* Make materials, scene and the surfaces of illum= the scene. */
static int
take_files(struct rifjob *j, struct rad_error *err)
{
    static const enum rif_var of[] = { RIF_MATERIALS, RIF_SCENE, RIF_ILLUM };
    char **words[3];
    int n[3], total = 0;

    for (int i = 0; i < 3; i++) {
        n[i] = rif_words(&j->rif, of[i], &words[i], err);
        if (n[i] < 0)
            return n[i];
        total += n[i];
    }
    j->scenes =
        rad_arena_calloc(&j->rif.arena, (size_t)total + 1, sizeof *j->scenes);
    if (!j->scenes)
        return rad_fail_memory(err);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < n[i]; k++)
            j->scenes[j->nscenes++] = words[i][k];
    return 0;
}

/* With illum=: use the octree that mkillum made, if it is newer than the scene
 * and these surfaces; else the files. */
static int
take_illum(struct rifjob *j, const char *octree, struct rad_error *err)
{
    char *made = illum_octree(j, octree);
    struct stat st;
    time_t when;
    int rc = scene_time(j, &when, err);

    if (rc < 0 || !made)
        return rc < 0 ? rc : rad_fail_memory(err);
    if (stat(made, &st) == 0 && st.st_mtime >= when)
        return take_octree(j, made, err);
    if (!is_given(j, RIF_SCENE) && access(octree, R_OK) == 0)
        return rif_fail(&j->rif, RIF_ILLUM, err,
                        "its surfaces cannot be added to an octree: give "
                        "scene=, or let rad run mkillum first");
    rc = note(j, RIF_ILLUM,
              "mkillum is not run: light through these surfaces is indirect "
              "light (-ab)",
              err);
    return rc < 0 ? rc : take_files(j, err);
}

/* The file's name without its last suffix. */
static char *
root_name(struct rifjob *j)
{
    const char *name = j->rif.name, *slash = strrchr(name, '/');
    const char *dot = strrchr(name, '.');

    if (!dot || (slash && dot < slash))
        dot = name + strlen(name);
    return format(j, "%.*s", (int)(dot - name), name);
}

static int
find_scene(struct rifjob *j, struct rad_error *err)
{
    const char *octree = rif_text(&j->rif, RIF_OCTREE);

    if (!octree)
        octree = format(j, "%s.oct", root_name(j));
    if (!octree)
        return rad_fail_memory(err);
    if (is_given(j, RIF_ILLUM))
        return take_illum(j, octree, err);
    if (is_given(j, RIF_SCENE))
        return take_files(j, err);
    if (access(octree, R_OK) == 0)
        return take_octree(j, format(j, "%s", octree), err);
    rad_error_where(err, "%s", j->rif.name);
    return rad_fail(err, RAD_ENOINPUT,
                    "no scene=, and no octree '%.100s' either", octree);
}

/* --- values that are refused, or noted --- */

static int
refuse(const struct rifjob *j, enum rif_var v, struct rad_error *err)
{
    int rc = rif_fail(&j->rif, v, err, "photon maps are not supported");

    if (err)
        err->code = RAD_EUNSUPPORTED;
    return rc < 0 ? RAD_EUNSUPPORTED : 0;
}

/* Note that a program which a value names is not run; rad would run it. */
static int
check_program(struct rifjob *j, enum rif_var v, char *const *words, int n,
              struct rad_error *err)
{
    char text[120];

    if (n == 0 || words[0][0] == '-')
        return 0;
    snprintf(text, sizeof text, "'%.60s' is not run", words[0]);
    return note(j, v, text, err);
}

/* Options -f, -n, -r and -w of oconv do not change a picture; -i is refused. */
static int
check_oconv(struct rifjob *j, struct rad_error *err)
{
    char **words;
    int n = rif_words(&j->rif, RIF_OCONV, &words, err), rc;

    if (n < 0)
        return n;
    if ((rc = check_program(j, RIF_OCONV, words, n, err)) < 0)
        return rc;
    for (int i = 0; i < n; i++)
        if (strcmp(words[i], "-i") == 0)
            return rif_fail(&j->rif, RIF_OCONV, err,
                            "-i: files cannot be added to an octree");
    return 0;
}

/* Multiply the exposure by -e of pfilt. */
static int
take_factor(struct rifjob *j, const char *value, struct rad_error *err)
{
    bool stops = value[0] == '+' || value[0] == '-';
    double e;

    if (!rad_parse_real(value, &e) || !(stops || e > 0))
        return rif_fail(&j->rif, RIF_PFILT, err,
                        "-e: expected stops with a sign, or a factor above 0");
    if (j->exposure == 0)
        return note(j, RIF_PFILT,
                    "'-e' is not done: there is no EXPOSURE to multiply", err);
    j->exposure *= stops ? exp2(e) : e;
    if (!(j->exposure >= 1e-20 && j->exposure <= 1e20))
        return rif_fail(&j->rif, RIF_PFILT, err, "-e: out of range");
    return 0;
}

/* Of pfilt's options -e is taken, and -r .6 is what the filter does; others are
 * noted. */
static int
check_pfilt(struct rifjob *j, struct rad_error *err)
{
    char **words, text[120];
    int n = rif_words(&j->rif, RIF_PFILT, &words, err), rc;

    if (n < 0)
        return n;
    if ((rc = check_program(j, RIF_PFILT, words, n, err)) < 0)
        return rc;
    for (int i = 0; i < n && rc == 0; i++) {
        const char *word = words[i], *value = i + 1 < n ? words[i + 1] : "";

        if (word[0] != '-' || strcmp(word, "-1") == 0)
            continue; /* the program, or the value of an option */
        if (strcmp(word, "-e") == 0) {
            rc = take_factor(j, value, err);
            i++;
        } else if (strcmp(word, "-r") != 0 || strtod(value, NULL) != .6) {
            snprintf(text, sizeof text,
                     "'%.40s' is not done: the filter is pfilt's -r .6", word);
            rc = note(j, RIF_PFILT, text, err);
        }
    }
    return rc;
}

static int
check_rpict(struct rifjob *j, struct rad_error *err)
{
    char **words;
    int n = rif_words(&j->rif, RIF_RPICT, &words, err);

    return n < 0 ? n : check_program(j, RIF_RPICT, words, n, err);
}

static int
check_raw(struct rifjob *j, struct rad_error *err)
{
    const char *raw = rif_text(&j->rif, RIF_RAWFILE);
    const char *picture = rif_text(&j->rif, RIF_PICTURE);

    if (!raw)
        return 0;
    j->raw = strcmp(raw, picture ? picture : root_name(j)) == 0;
    if (j->raw) {
        j->exposure = 0;
        return 0;
    }
    return note(j, RIF_RAWFILE,
                "pictures are filtered as they are made, and none is kept as "
                "it was before",
                err);
}

static int
check_rest(struct rifjob *j, struct rad_error *err)
{
    static const enum rif_var photons[] = { RIF_MKPMAP, RIF_PGMAP, RIF_PCMAP };
    int rc;

    for (int i = 0; i < 3; i++)
        if (is_given(j, photons[i]))
            return refuse(j, photons[i], err);
    if ((rc = rif_exposure(&j->rif, &j->exposure, err)) < 0 ||
        (rc = check_oconv(j, err)) < 0 || (rc = check_pfilt(j, err)) < 0 ||
        (rc = check_rpict(j, err)) < 0 || (rc = check_raw(j, err)) < 0)
        return rc;
    if (j->exposure == 0 && !j->raw)
        rc = note(j, RIF_EXPOSURE,
                  "not given: pictures hold radiance (rad has pfilt choose)",
                  err);
    return rc;
}

int
rifjob_begin(struct rifjob *j, struct submit_options *o, struct words *w,
             struct rad_error *err)
{
    unsigned char *text;
    size_t len;
    int rc;

    if (o->nscenes == 0 || !outname_suffix(o->scenes[0], ".rif"))
        return 0;
    text = rad_file_read(o->scenes[0], RIF_MAX_BYTES, &len, err);
    if (!text)
        return err->code;
    j->is = true;
    rc = rif_parse(&j->rif, o->scenes[0], (const char *)text, len, err);
    free(text);
    for (int i = 1; i < o->nscenes && rc == 0; i++)
        rc = rif_assign(&j->rif, o->scenes[i], err);
    if (rc == 0)
        rc = rif_check(&j->rif, err);
    if (rc < 0)
        return rc;
    j->notes = rad_arena_calloc(&j->rif.arena, MOST_NOTES, sizeof *j->notes);
    if (!j->notes)
        return rad_fail_memory(err);
    if ((rc = check_rest(j, err)) < 0 || (rc = find_scene(j, err)) < 0)
        return rc;
    rc = inputs_add(&w->inputs, "the file of variables", j->rif.name, err);
    for (int i = 0; i < j->nscenes && rc == 0; i++)
        rc = inputs_add(&w->inputs, "the scene", j->scenes[i], err);
    j->ngiven = (int)(o->scenes - w->list);
    o->scenes = j->scenes;
    o->nscenes = j->nscenes;
    return rc;
}

void
rifjob_release(struct rifjob *j)
{
    if (!j->is)
        return;
    words_release(&j->given);
    rif_release(&j->rif);
    memset(j, 0, sizeof *j);
}

/* --- the options --- */

/* Append the file's options, except for views.  If the command line has
 * --quality, that replaces rad's rules. */
static int
add_file(struct rif_line *l, struct rifjob *j, const struct submit_options *o)
{
    int rc = rif_line_options(l, &j->zone, o->quality < 0, j->raw);
    char *root;

    j->optfile = l->optfile;
    if (rc < 0 || o->detach)
        return rc;
    root = root_name(j);
    return root ? rif_line_outputs(l, root, (enum picfile_format)o->format)
                : rad_fail_memory(l->err);
}

/* Make the command line of one view: its options, the file's, those of the real
 * command line, and the scene's files. */
static int
make_line(struct rif_line *l, struct rifjob *j, const struct submit_options *o,
          const struct words *w, const struct rif_view *v)
{
    int rc = rif_line_add(l, "radsubmit");

    if (rc == 0)
        rc = rif_line_words(l, v->words, v->nwords);
    if (rc == 0)
        rc = add_file(l, j, o);
    if (rc == 0)
        rc = rif_line_words(l, w->list, j->ngiven);
    if (rc == 0 && strcmp(l->list[l->n - 1], "--") != 0)
        rc = rif_line_add(l, "--");
    return rc < 0 ? rc : rif_line_words(l, j->scenes, j->nscenes);
}

/* Parse a whole line, unless rc says that it is none; *words is to be released
 * in any case. */
static int
parse_line(int rc, const struct rif_line *l, struct words *words,
           struct submit_options *parsed)
{
    *words = (struct words){ .n = 0 };
    if (rc == 0)
        rc = words_init(words, l->n, l->list, l->err);
    return rc == 0 ? submit_parse(parsed, words, l->err) : rc;
}

/* Are these options wrong by themselves? */
static bool
is_faulty(struct rifjob *j, char *const *list, int n)
{
    struct rad_error why = { 0 };
    struct rif_line l = { .rif = &j->rif, .err = &why };
    struct submit_options parsed;
    struct words words;
    int rc = rif_line_add(&l, "radsubmit");

    if (rc == 0)
        rc = rif_line_words(&l, list, n);
    if (rc == 0)
        rc = rif_line_add(&l, "--");
    if (rc == 0)
        rc = rif_line_words(&l, j->scenes, j->nscenes);
    rc = parse_line(rc, &l, &words, &parsed);
    words_release(&words);
    return rc < 0;
}

/* Of wrong options: the line of the file that has them; 0: not a single line.
 */
static int
faulty_line(struct rifjob *j, const struct rif_view *v)
{
    static const enum rif_var of[] = { RIF_RENDER, RIF_RPICT };

    if (v->line > 0 && is_faulty(j, v->words, v->nwords))
        return v->line;
    for (int i = 0; i < 2; i++)
        for (const struct rif_value *a = j->rif.first[of[i]]; a; a = a->next) {
            struct rad_error why = { 0 };
            char **words;
            int n = rif_split(&j->rif, a->text, &words, &why);

            if (n > 0 && is_faulty(j, words, n))
                return a->line;
        }
    return 0;
}

/* Parse the command line of view i.  For the first one the result replaces *o
 * and *w. */
static int
take_view(struct rifjob *j, struct submit_options *o, struct words *w, int i,
          const struct rif_view *v, struct rad_error *err)
{
    /* the real command line, which *w has only before the first view */
    const struct words *given = i == 0 ? w : &j->given;
    struct rif_line l = { .rif = &j->rif, .err = err };
    struct submit_options parsed;
    struct words words;
    int rc = make_line(&l, j, o, given, v);

    if ((rc = parse_line(rc, &l, &words, &parsed)) < 0) {
        int line = faulty_line(j, v);

        if (line > 0)
            rad_error_where(err, "%s:%d", j->rif.name, line);
        else
            rad_error_where(err, "%s", j->rif.name);
        words_release(&words);
        return rc;
    }
    j->views[i].view = parsed.view;
    j->views[i].name = v->name;
    j->views[i].number = (uint32_t)v->number;
    if (i > 0) {
        words_release(&words);
        return 0;
    }
    j->given = *w;
    *w = words;
    *o = parsed;
    return 0;
}

/* Note further files that were read, which must not be overwritten. */
static int
note_inputs(const struct rifjob *j, struct words *w,
            const struct rif_view *views, struct rad_error *err)
{
    int rc = inputs_add(&w->inputs, "the file of variables", j->rif.name, err);

    for (int i = 0; i < j->nviews; i++)
        for (int k = 0; k + 1 < views[i].nwords && rc == 0; k++)
            if (strcmp(views[i].words[k], "-vf") == 0)
                rc = inputs_add(&w->inputs, "a view file",
                                views[i].words[k + 1], err);
    return rc;
}

int
rifjob_finish(struct rifjob *j, struct submit_options *o, struct words *w,
              const struct rad_octree *t, struct rad_error *err)
{
    struct rif_view *views;
    int rc;

    if (o->first_frame)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-S': the views are those of '%s'",
                        j->rif.name);
    if ((rc = rif_zone(&j->rif, t, &j->zone, err)) < 0 ||
        (rc = rif_views(&j->rif, &j->zone, o->rif_view, &views, err)) < 0)
        return rc;
    j->nviews = rc;
    j->views = rad_arena_calloc(&j->rif.arena, (size_t)rc, sizeof *j->views);
    if (!j->views)
        return rad_fail_memory(err);
    rc = 0;
    for (int i = 0; i < j->nviews && rc == 0; i++)
        rc = take_view(j, o, w, i, &views[i], err);
    if (rc < 0)
        return rc;
    if (!o->name)
        o->name = j->rif.name;
    o->params.motion = 0; /* only for one picture of a sequence */
    if (j->exposure > 0 && !o->exposure) { /* for pictures written as .png */
        o->show.screen.tone.absolute = true;
        o->show.screen.tone.exposure = j->exposure;
    }
    return note_inputs(j, w, views, err);
}

static int
remove_old_ambient(struct rifjob *j, const struct submit_options *o,
                   struct rad_error *err)
{
    const char *ambient = rif_text(&j->rif, RIF_AMBFILE);
    struct stat st, scene;
    time_t when;
    int rc;

    if (!ambient || !o->ambient || strcmp(ambient, o->ambient) != 0 ||
        stat(ambient, &st) != 0)
        return 0;
    if ((rc = scene_time(j, &when, err)) < 0)
        return rc;
    if (j->nscenes == 1 && stat(j->scenes[0], &scene) == 0 &&
        scene.st_mtime > when)
        when = scene.st_mtime;
    if (when <= st.st_mtime)
        return 0;
    if (unlink(ambient) != 0)
        return rad_fail(err, RAD_ECANTCREAT, "cannot remove '%s': %s", ambient,
                        strerror(errno));
    return note(j, RIF_AMBFILE,
                "its values were older than the scene, and are removed", err);
}

int
rifjob_prepare(struct rifjob *j, const struct submit_options *o,
               struct rad_error *err)
{
    const char *optfile;
    int rc = remove_old_ambient(j, o, err);

    optfile = rif_text(&j->rif, RIF_OPTFILE);
    if (rc < 0 || !optfile)
        return rc;
    return rad_output_write(optfile, j->optfile, strlen(j->optfile), false,
                            err);
}
