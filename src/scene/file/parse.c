/* parse.c - see parse.h
 *
 *     modifier type name                 modifier alias name old-name
 *     n string1 .. stringn
 *     0
 *     n real1 .. realn
 *
 * A struct reader is one text.  A command's output has a reader of its own,
 * which is read while the outer one waits.  Arguments are collected in buffers
 * that are used for all objects in turn. */
#include "config.h"

#include "scene/file/parse.h"

#include "base/number.h"
#include "base/text.h"
#include "scene/file/lex.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define MODIFIER_INHERIT (-2) /* of an alias: the old name's modifier */

/* Arguments of the object being read. */
struct arguments {
    char *text; /* strings, one after the other, with their NULs */
    size_t text_size, text_used;
    const char **strings;
    double *reals;
    int nstrings, nreals;
    int max_strings, max_reals; /* allocated */
};

/* State that all readers share. */
struct parser {
    struct rad_scene *scene;
    const struct rad_parse_io *io;
    struct arguments args;
    struct rad_error first; /* error after which reading went on */
};

/* A text that is being read. */
struct reader {
    struct parser *parser;
    int depth; /* of nested commands */
    int32_t file;
    struct rad_lex lex;
};

/* --- errors ------------------------------------------------------------ */

static int
fail_at(const struct reader *r, int line, struct rad_error *err)
{
    rad_error_where(err, "%s:%d", r->parser->scene->files[r->file], line);
    return err->code;
}

/* Put the object's type and name in front of an error's text. */
static void
name_object(const struct rad_object *o, struct rad_error *err)
{
    char what[sizeof err->what];

    memcpy(what, err->what, sizeof what);
    snprintf(err->what, sizeof err->what, "%s '%.60s': %.180s",
             rad_otype_name(o->type), o->name, what);
}

/* Note an error after which reading can go on, if io->each wants further
 * errors: returns 0 to go on, else the error's code, with *err set. */
static int
survive(struct reader *r, int line, struct rad_error *now,
        struct rad_error *err)
{
    const struct rad_parse_io *io = r->parser->io;

    fail_at(r, line, now);
    if (!io || !io->each) {
        *err = *now;
        return now->code;
    }
    io->each(io->arg, now);
    if (r->parser->first.code == 0)
        r->parser->first = *now;
    return 0;
}

/* --- arguments ---------------------------------------------------------- */

/* Grow `old`, which has room for *max elements of `size` bytes, to n or more;
 * NULL: memory is out, and old is unchanged. */
static void *
grow(void *old, size_t size, int *max, int n, struct rad_error *err)
{
    void *more;

    if (n <= *max)
        return old;
    n += n / 2 + 16;
    more = realloc(old, (size_t)n * size);
    if (more)
        *max = n;
    else
        rad_fail_memory(err);
    return more;
}

static int
reserve_strings(struct arguments *a, int n, struct rad_error *err)
{
    const char **more = grow(a->strings, sizeof *more, &a->max_strings, n, err);

    if (n && !more)
        return RAD_ENOMEM;
    a->strings = more;
    return 0;
}

static int
reserve_reals(struct arguments *a, int n, struct rad_error *err)
{
    double *more = grow(a->reals, sizeof *more, &a->max_reals, n, err);

    if (n && !more)
        return RAD_ENOMEM;
    a->reals = more;
    return 0;
}

/* Keep a word as the next string argument.  Since the buffer may move, pointers
 * to strings are set when all have been read. */
static int
keep_string(struct arguments *a, const char *word, struct rad_error *err)
{
    size_t n = strlen(word) + 1;

    if (n > a->text_size - a->text_used) {
        size_t size = 2 * a->text_size + n;
        char *more = realloc(a->text, size);

        if (!more)
            return rad_fail_memory(err);
        a->text = more;
        a->text_size = size;
    }
    memcpy(a->text + a->text_used, word, n);
    a->text_used += n;
    return 0;
}

/* The count that the text claims allocates nothing: buffers grow as words are
 * read. */
static int
read_strings(struct rad_lex *lex, struct arguments *a, struct rad_error *err)
{
    const char *p;
    int n, rc;

    a->nstrings = 0;
    a->text_used = 0;
    rc = rad_lex_count(lex, "the number of string arguments", RAD_MAX_ARGS, &n,
                       err);
    for (; !rc && a->nstrings < n; a->nstrings++) {
        rc = rad_lex_word(lex, "a string argument", err);
        if (!rc)
            rc = keep_string(a, lex->word, err);
    }
    if (!rc)
        rc = reserve_strings(a, n, err);
    if (rc)
        return rc;
    p = a->text;
    for (int i = 0; i < n; i++, p += strlen(p) + 1)
        a->strings[i] = p;
    return 0;
}

static int
read_reals(struct rad_lex *lex, struct arguments *a, struct rad_error *err)
{
    int n, rc;

    a->nreals = 0;
    rc =
        rad_lex_count(lex, "the number of integer arguments", INT_MAX, &n, err);
    if (!rc && n)
        rc = rad_fail(err, RAD_EDATA,
                      "expected 0 integer arguments, got %d: no type has any",
                      n);
    if (!rc)
        rc = rad_lex_count(lex, "the number of real arguments", RAD_MAX_ARGS,
                           &n, err);
    while (!rc && a->nreals < n) {
        rc = reserve_reals(a, a->nreals + 1, err);
        if (!rc)
            rc = rad_lex_real(lex, &a->reals[a->nreals++], err);
    }
    return rc;
}

/* --- objects ------------------------------------------------------------ */

/* Files that are no scenes, by how their names end. */
static const struct {
    const char *end, *advice;
} other_files[] = {
    { ".obj", ": no scene; obj2rad makes one of it" },
    { ".ies", ": no scene; ies2rad makes one of it" },
    { ".hdr", ": a picture is no scene" },
    { ".pic", ": a picture is no scene" },
};

/* What to add to the error of a modifier that is not defined. */
static const char *
advise(const struct reader *r, const char *word)
{
    const char *end = strrchr(r->parser->scene->files[r->file], '.');
    double number;

    if (rad_text_mark(word, strlen(word)) > 0)
        return ": a byte-order mark is before it: save its file without";
    for (size_t i = 0; end && i < sizeof other_files / sizeof *other_files; i++)
        if (strcasecmp(end, other_files[i].end) == 0)
            return other_files[i].advice;
    return rad_parse_real(word, &number)
               ? ": are there more arguments before it than their number says?"
               : "";
}

static int
read_modifier(struct reader *r, struct rad_object *o, struct rad_error *err)
{
    struct rad_error now = { 0 };
    const char *word = r->lex.word;
    int rc = rad_lex_word(&r->lex, "a modifier", err);

    if (rc)
        return rc;
    o->modifier = RAD_VOID;
    if (strcmp(word, "void") == 0)
        return 0;
    if (strcmp(word, "inherit") == 0) {
        o->modifier = MODIFIER_INHERIT;
        return 0;
    }
    o->modifier = rad_scene_find_modifier(r->parser->scene, word, INT32_MAX);
    if (o->modifier != RAD_VOID)
        return 0;
    rad_fail(&now, RAD_EDATA, "undefined modifier '%s'%s", word,
             advise(r, word));
    return survive(r, r->lex.line, &now, err);
}

/* Read a type.  An object of unknown type is read like others, and becomes an
 * alias, so that its name is not reported as undefined later. */
static int
read_type(struct reader *r, struct rad_object *o, bool *known,
          struct rad_error *err)
{
    struct rad_error now = { 0 };
    int type, rc = rad_lex_next(&r->lex, err); /* to skip comments */

    if (rc == RAD_TOKEN_COMMAND)
        return rad_fail(err, RAD_EDATA, "expected a type, got '!'");
    if (rc >= 0)
        rc = rad_lex_word(&r->lex, "a type", err);
    if (rc)
        return rc;
    type = rad_otype_find(r->lex.word);
    *known = type >= 0;
    o->type = *known ? (enum rad_otype)type : RAD_ALIAS;
    if (*known)
        return 0;
    rad_fail(&now, RAD_EDATA, "unknown type '%s'", r->lex.word);
    return survive(r, r->lex.line, &now, err);
}

static int
read_name(struct reader *r, const struct rad_object *o, char *name,
          struct rad_error *err)
{
    int rc = rad_lex_word(&r->lex, "a name", err);

    if (rc)
        return rc;
    strcpy(name, r->lex.word);
    if (strchr(name, '\t'))
        return rad_fail(err, RAD_EDATA, "tab in name '%s'", name);
    if (!rad_otype_is_surface(o->type) &&
        (strcmp(name, "void") == 0 || strcmp(name, "inherit") == 0))
        return rad_fail(err, RAD_EDATA, "a %s cannot be called '%s'",
                        rad_otype_name(o->type), name);
    return 0;
}

/* Read the name that an alias refers to.  An alias that does not change the
 * modifier becomes a plain replacement: it has no string argument, and its
 * modifier is the object that it stands for.  This keeps chains of aliases
 * short. */
static int
read_alias(struct reader *r, struct rad_object *o, struct rad_error *err)
{
    const struct rad_object *objects = r->parser->scene->objects;
    struct arguments *a = &r->parser->args;
    struct rad_error now = { 0 };
    int rc = rad_lex_word(&r->lex, "what the alias stands for", err);
    int32_t ref;

    if (rc)
        return rc;
    ref = rad_scene_find_modifier(r->parser->scene, r->lex.word, INT32_MAX);
    if (ref == RAD_VOID) {
        if (strcmp(r->lex.word, "void") == 0)
            rad_fail(&now, RAD_EDATA, "alias '%s' of nothing", o->name);
        else
            rad_fail(&now, RAD_EDATA, "alias '%s' of undefined modifier '%s'",
                     o->name, r->lex.word);
        if (o->modifier == MODIFIER_INHERIT)
            o->modifier = RAD_VOID;
        return survive(r, r->lex.line, &now, err);
    }
    while (objects[ref].type == RAD_ALIAS && objects[ref].nstrings == 0 &&
           objects[ref].modifier != RAD_VOID)
        ref = objects[ref].modifier;
    if (o->modifier == MODIFIER_INHERIT ||
        o->modifier == objects[ref].modifier) {
        o->modifier = ref;
        return 0;
    }
    a->text_used = 0;
    rc = keep_string(a, r->lex.word, err);
    if (!rc)
        rc = reserve_strings(a, 1, err);
    if (rc)
        return rc;
    a->strings[0] = a->text;
    o->strings = a->strings;
    o->nstrings = 1;
    return 0;
}

static int
read_arguments(struct reader *r, struct rad_object *o, struct rad_error *err)
{
    struct arguments *a = &r->parser->args;
    int rc = read_strings(&r->lex, a, err);

    if (!rc)
        rc = read_reals(&r->lex, a, err);
    o->nstrings = a->nstrings;
    o->strings = a->strings;
    o->nreals = a->nreals;
    o->reals = a->reals;
    return rc;
}

static int
read_object(struct reader *r, struct rad_error *err)
{
    struct rad_object o = { .file = r->file, .line = r->lex.line };
    char name[RAD_MAX_WORD + 1];
    bool known = true;
    int rc = read_modifier(r, &o, err);

    o.name = name;
    if (!rc)
        rc = read_type(r, &o, &known, err);
    if (!rc)
        rc = read_name(r, &o, name, err);
    if (rc)
        return rc;
    if (o.modifier == MODIFIER_INHERIT && (o.type != RAD_ALIAS || !known))
        return rad_fail(err, RAD_EDATA,
                        "only an alias can have the modifier 'inherit'");
    if (o.type == RAD_ALIAS && known) {
        rc = read_alias(r, &o, err);
    } else {
        rc = read_arguments(r, &o, err);
        if (rc)
            name_object(&o, err);
    }
    if (!known)
        o.nstrings = o.nreals = 0;
    if (!rc)
        rc = rad_scene_add(r->parser->scene, &o, err);
    return rc < 0 ? rc : 0;
}

/* --- texts -------------------------------------------------------------- */

static int read_text(struct reader *r, struct rad_error *err);

static struct reader *
new_reader(struct parser *p, const struct rad_stream *in, const char *name,
           int depth, struct rad_error *err)
{
    struct reader *r = malloc(sizeof *r);
    int file = rad_scene_add_file(p->scene, name, err);

    if (!r || file < 0) {
        free(r);
        rad_fail_memory(err);
        return NULL;
    }
    r->parser = p;
    r->depth = depth;
    r->file = file;
    rad_lex_init(&r->lex, in);
    return r;
}

/* Read a command's output, as a text whose name says file, line and command. */
static int
read_output(struct reader *r, const char *command, int line,
            const struct rad_stream *out, struct rad_error *err)
{
    char name[256];
    struct reader *below;
    int rc, shown = (int)strcspn(command, "\n");

    if (shown > 60)
        shown = 60;
    snprintf(name, sizeof name, "%.160s:%d (!%.*s%s)",
             r->parser->scene->files[r->file], line, shown, command,
             command[shown] ? "..." : "");
    below = new_reader(r->parser, out, name, r->depth + 1, err);
    if (!below)
        return RAD_ENOMEM;
    rc = read_text(below, err);
    free(below);
    return rc;
}

static int
run_command(struct reader *r, const char *command, int line,
            struct rad_error *err)
{
    const struct rad_parse_io *io = r->parser->io;
    struct rad_stream out;
    struct rad_error late = { 0 };
    void *job;
    int rc, end;

    if (!io || !io->begin_command)
        return rad_fail(err, RAD_EDATA, "commands are not run here: '!%.60s'",
                        command);
    if (r->depth == RAD_MAX_NESTING)
        return rad_fail(err, RAD_EDATA, "commands are nested too deeply");
    rc = io->begin_command(io->arg, command, &out, &job, err);
    if (rc)
        return rc;
    rc = read_output(r, command, line, &out, err);
    end = io->end_command(io->arg, job, rc != 0, &late);
    if (rc == 0 && end)
        rc = survive(r, line, &late, err);
    return rc;
}

static int
read_command(struct reader *r, struct rad_error *err)
{
    char *command = malloc(RAD_MAX_COMMAND + 1);
    int rc, line = r->lex.line;

    if (!command)
        return rad_fail_memory(err);
    rc = rad_lex_line(&r->lex, command, RAD_MAX_COMMAND + 1, err);
    if (!rc)
        rc = run_command(r, command, line, err);
    if (rc)
        fail_at(r, line, err);
    free(command);
    return rc;
}

/* Warn of a text without objects. */
static void
warn_of_empty(const struct reader *r)
{
    const struct rad_parse_io *io = r->parser->io;
    struct rad_error now = { 0 };

    if (!io || !io->warn)
        return;
    rad_fail(&now, RAD_WARNING, "empty file");
    rad_error_where(&now, "%s", r->parser->scene->files[r->file]);
    io->warn(io->arg, &now);
}

static int
read_text(struct reader *r, struct rad_error *err)
{
    int32_t before = r->parser->scene->nobjects;
    int rc = 0;

    while (!rc) {
        int token = rad_lex_next(&r->lex, err);

        if (token == RAD_TOKEN_END) {
            if (r->parser->scene->nobjects == before)
                warn_of_empty(r);
            return 0;
        }
        if (token == RAD_TOKEN_COMMAND)
            rc = read_command(r, err);
        else
            rc = token < 0 ? token : read_object(r, err);
    }
    fail_at(r, r->lex.line, err);
    return rc;
}

int
rad_parse(struct rad_scene *s, const struct rad_stream *in, const char *name,
          const struct rad_parse_io *io, struct rad_error *err)
{
    struct parser p = { .scene = s, .io = io };
    struct rad_error last = { 0 };
    struct reader *r = new_reader(&p, in, name, 0, &last);
    int rc = r ? read_text(r, &last) : RAD_ENOMEM;

    if (rc && io && io->each)
        io->each(io->arg, &last);
    if (p.first.code == 0)
        p.first = last;
    if (err && err->code == 0)
        *err = p.first;
    free(r);
    free(p.args.text);
    free(p.args.strings);
    free(p.args.reals);
    return p.first.code;
}

int
rad_parse_text(struct rad_scene *s, const char *text, size_t len,
               const char *name, const struct rad_parse_io *io,
               struct rad_error *err)
{
    struct rad_memory_in from = { text, len };
    struct rad_stream in = rad_memory_stream(&from);

    return rad_parse(s, &in, name, io, err);
}
