/* radscene.c - examine scenes: check, info, needs, freeze, rays */
#include "config.h"

#include "base/output.h"
#include "compile/compile.h"
#include "scene/overlap.h"
#include "rays.h"
#include "scene/meshfile.h"
#include "scene/octfile.h"
#include "trace/material.h"
#include "common/tell.h"
#include "compile/warning.h"
#include "common/words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static const char usage_text[] =
    "usage: radscene check [--commands] FILE...\n"
    "       radscene info [--commands] FILE...\n"
    "       radscene needs [--commands] FILE...\n"
    "       radscene freeze [--commands] FILE... > scene.oct\n"
    "       radscene rays [--commands] [-I] [-co] [-af FILE] "
    "[rendering options]\n"
    "                FILE...\n"
    "       radscene --help | --version\n";

static const char help_text[] =
    "\n"
    "FILE... is a scene: one octree, or scene text; \"-\" is the standard "
    "input.\n"
    "  check   tell every error, with file and line\n"
    "  info    objects, light sources, bounds\n"
    "  needs   the types that the scene's surfaces use, one a line\n"
    "  freeze  write an octree that Radiance's programs read\n"
    "  rays    trace the rays of the standard input, six numbers a line:\n"
    "          origin and direction, or with -I a point and its normal;\n"
    "          prints radiance, or irradiance, as \"r g b\", or with -co+ "
    "band by band\n"
    "  --commands  run the commands of an octree's scene files, too\n";

/* The last error and the last warning that were printed. */
struct told {
    char last[2][600];
};

/* Print an error or a warning, unless it is the same as the last of its kind.
 * Objects of an octree have no lines, so a thousand of them that lack a file
 * give the same message. */
static void
print_each(void *arg, const struct rad_error *err)
{
    struct told *told = arg;
    char message[600], *last = told->last[err->code == RAD_WARNING];

    rad_error_format(err, message, sizeof message);
    if (strcmp(message, last) == 0)
        return;
    strcpy(last, message);
    fprintf(stderr, "radscene: %s%s\n",
            err->code == RAD_WARNING ? "warning: " : "", message);
}

/* Keep the first error, but for types that the renderer lacks. */
static void
keep_first(void *arg, const struct rad_error *err)
{
    struct rad_error *first = arg;

    if (err->code != RAD_EUNSUPPORTED && err->code != RAD_WARNING &&
        first->code == 0)
        *first = *err;
}

/* Read a scene; types that the renderer lacks are no error. */
static int
read_any(struct compiled *c, const struct compile_from *from,
         struct rad_error *err)
{
    int rc = compile_parse(c, from, err);

    if (rc)
        return rc;
    rad_scene_check(c->scene, keep_first, err, NULL);
    if (err->code)
        compile_release(c);
    return err->code;
}

/* --- info ------------------------------------------------------------------
 */

struct summary {
    long surfaces, sources;
    long count[RAD_NOTYPES];
    double lo[3], hi[3];
};

static void
summarize(struct summary *sum, const struct rad_scene *s)
{
    memset(sum, 0, sizeof *sum);
    for (int i = 0; i < 3; i++) {
        sum->lo[i] = INFINITY;
        sum->hi[i] = -INFINITY;
    }
    for (int32_t i = 0; i < rad_scene_own(s); i++) {
        const struct rad_object *o = &s->objects[i];
        struct rad_extent e;

        sum->count[o->type]++;
        if (!rad_otype_is_surface(o->type))
            continue;
        sum->surfaces++;
        sum->sources += rad_surface_lights(s, i);
        if (!rad_extent_of(o, &e))
            continue;
        for (int k = 0; k < 3; k++) {
            sum->lo[k] = fmin(sum->lo[k], e.lo[k] + e.slack);
            sum->hi[k] = fmax(sum->hi[k], e.hi[k] - e.slack);
        }
    }
}

/* Print the files of instances and meshes, with what they contain. */
static void
print_parts(const struct rad_scene *s)
{
    long *copies = calloc((size_t)s->nparts + 1, sizeof *copies);

    for (int32_t i = 0; i < s->nobjects && copies; i++)
        if (s->objects[i].use)
            copies[s->objects[i].use->part->index]++;
    for (int32_t i = 0; i < s->nparts && copies; i++) {
        const struct rad_part *p = s->parts[i];
        const char *what = p->mesh ? "triangles" : "objects";
        long n = p->mesh ? (long)p->mesh->ntris : (long)p->n;

        tell(stdout, "file %s %s %s %ld copies %ld", p->name,
             rad_otype_name(p->type), what, n, copies[i]);
    }
    free(copies);
}

/* Print the other files, each once if the objects that name it follow one
 * another. */
static void
print_files(const struct rad_scene *s)
{
    uint8_t *reached = malloc((size_t)s->nobjects + 1);
    const char *name, *last = "";

    if (reached)
        rad_scene_reach(s, reached);
    for (int32_t i = 0; i < s->nobjects && reached; i++)
        for (int k = 0;
             reached[i] && (name = rad_object_file(&s->objects[i], k)); k++) {
            if (strcmp(name, last) != 0)
                tell(stdout, "file %s", name);
            last = name;
        }
    free(reached);
}

static int
run_info(struct compiled *c, struct rad_error *err)
{
    struct summary sum;

    (void)err;
    summarize(&sum, c->scene);
    printf("objects %ld\n", (long)rad_scene_own(c->scene));
    printf("surfaces %ld\n", sum.surfaces);
    printf("sources %ld\n", sum.sources);
    if (sum.lo[0] <= sum.hi[0])
        printf("bounds %.9g %.9g %.9g  %.9g %.9g %.9g\n", sum.lo[0], sum.lo[1],
               sum.lo[2], sum.hi[0], sum.hi[1], sum.hi[2]);
    for (int t = 0; t < RAD_NOTYPES; t++)
        if (sum.count[t])
            printf("  %s %ld\n", rad_otype_name((enum rad_otype)t),
                   sum.count[t]);
    print_parts(c->scene);
    print_files(c->scene);
    return 0;
}

/* --- the other subcommands ------------------------------------------------ */

static int
run_needs(struct compiled *c, struct rad_error *err)
{
    bool needs[RAD_NOTYPES];

    (void)err;
    rad_scene_needs(c->scene, needs);
    for (int t = 0; t < RAD_NOTYPES; t++)
        if (needs[t])
            puts(rad_otype_name((enum rad_otype)t));
    return 0;
}

static void
say_warnings(const struct compiled *c)
{
    char warning[WARNING_SIZE];

    for (int i = 0; warning_of(c, i, warning); i++)
        tell(stderr, "radscene: %s", warning);
}

static int
run_freeze(struct compiled *c, struct rad_error *err)
{
    struct rad_fd to = { STDOUT_FILENO, "standard output" };
    struct rad_sink out = rad_fd_sink(&to);
    int rc;

    if (isatty(STDOUT_FILENO))
        return rad_fail(err, RAD_EUSAGE,
                        "the octree is binary: send it to a file");
    rc = compile_octree(c, RAD_OCTREE_LEAF, err);
    if (rc)
        return rc;
    say_warnings(c);
    return rad_octfile_write(c->scene, &c->octree, &out, err);
}

static int
run_check(struct compiled *c, struct rad_error *err)
{
    int rc = compile_check(c, err);

    say_warnings(c);
    return rc;
}

static void
warn_of_faults(const struct rad_scene *scene, const struct rad_fault *f)
{
    char text[WARNING_SIZE];

    for (int i = 0; i < RAD_MAX_FAULTS && f[i].count > 0; i++)
        if (warning_fault(scene, (uint32_t)f[i].object, f[i].count, text))
            tell(stderr, "radscene: %s", text);
}

/* `radscene rays`: options come before the files. */
static int
run_rays(int argc, char **argv, struct rad_error *err)
{
    struct rad_fault faults[RAD_MAX_FAULTS];
    struct rays_options options;
    struct compile_from from;
    struct compiled c;
    struct rad_files files;
    struct words w;
    char digest[RAD_SHA_HEX + 1] = "";
    int first, rc = words_init(&w, argc, argv, err);

    if (rc)
        return rc;
    first = rays_options(&options, &w, err);
    from = (struct compile_from){ (const char *const *)w.list + first,
                                  w.n - first, options.commands };
    rc = first < 0 ? first : compile_read(&c, &from, NULL, NULL, err);
    if (!rc) {
        files = compile_files(&c);
        memset(faults, 0, sizeof faults);
        if (options.ambfile)
            rc = compile_digest(&c, digest, err);
        if (!rc)
            rc = rays_run(&options,
                          &(struct rays_scene){ c.scene, &files, digest },
                          stdin, stdout, faults, err);
        warn_of_faults(c.scene, faults);
        compile_release(&c);
    }
    words_release(&w);
    return rc;
}

static const struct subcommand {
    const char *name;
    bool strict; /* the scene must be renderable, and all errors are printed */
    int (*run)(struct compiled *c, struct rad_error *err);
} subcommands[] = {
    { "check", true, run_check },
    { "info", false, run_info },
    { "needs", false, run_needs },
    { "freeze", false, run_freeze },
};

/* Run a subcommand; argv has its name and its files.  If an error of reading
 * was printed *err has no code: want of memory may end reading without one. */
static int
run_on_files(const struct subcommand *sub, int argc, char **argv,
             struct rad_error *err)
{
    bool commands = argc > 1 && strcmp(argv[1], "--commands") == 0;
    const char *const *files = (const char *const *)argv + 1 + commands;
    bool dashes = argc > 1 + commands && strcmp(files[0], "--") == 0;
    struct compile_from from = { files + dashes, argc - 1 - commands - dashes,
                                 commands };
    struct told told = { 0 };
    struct compiled c;
    int rc;

    if (from.n < 1)
        return rad_fail(err, RAD_EUSAGE, "no scene file");
    for (int i = 0; i < from.n && !dashes; i++)
        if (files[i][0] == '-' && files[i][1] != '\0')
            return rad_fail(err, RAD_EUSAGE, "unknown option '%s'", files[i]);
    rc = sub->strict ? compile_read(&c, &from, print_each, &told, err)
                     : read_any(&c, &from, err);
    if (!rc) {
        rc = sub->run(&c, err);
        compile_release(&c);
    }
    if (told.last[0][0])
        memset(err, 0, sizeof *err);
    return rc;
}

int
main(int argc, char **argv)
{
    struct rad_error err = { 0 };
    const struct subcommand *sub = NULL;
    const char *name = argc > 1 ? argv[1] : "";
    int rc = 0;

    rad_output_guard();
    for (size_t i = 0; i < sizeof subcommands / sizeof subcommands[0]; i++)
        if (strcmp(name, subcommands[i].name) == 0)
            sub = &subcommands[i];
    if (strcmp(name, "--help") == 0 ||
        (argc > 2 && strcmp(argv[2], "--help") == 0)) {
        printf("%s%s", usage_text, help_text);
    } else if (strcmp(name, "--version") == 0) {
        puts("radscene (radd) " PACKAGE_VERSION);
    } else if (sub) {
        rc = run_on_files(sub, argc - 1, argv + 1, &err);
    } else if (strcmp(name, "rays") == 0) {
        rc = run_rays(argc - 1, argv + 1, &err);
    } else {
        if (name[0] == '-')
            tell(stderr, "radscene: unknown option '%s'", name);
        else if (name[0])
            tell(stderr, "radscene: unknown command '%s'", name);
        fputs(usage_text, stderr);
        return EX_USAGE;
    }
    if (!rc)
        rc = tell_printed(&err);
    if (rc && err.code)
        print_each(&(struct told){ 0 }, &err);
    return rad_exit_status(rc);
}
