/* raderr.c - how far a picture is from another */
#include "config.h"

#include "output.h"
#include "picture/falsecolour.h"
#include "picture/metric.h"
#include "picture/number.h"
#include "picture/png.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define MOST_BYTES  ((size_t)1 << 32)
#define MOST_PIXELS ((size_t)1 << 28)

static const char usage_text[] =
    "usage: raderr [-1] [-b N] [-c X] [-d N] [--map=OUT.png] "
    "TEST.hdr REF.hdr\n"
    "       raderr --false-colour=OUT.png PICTURE.hdr\n"
    "       raderr --help | --version\n";

static const char help_text[] =
    "\n"
    "Prints mean_ratio, nrmse, log_rmse, p50, p95, p99.9, max and maxabs of\n"
    "TEST against REF, in units of radiance; raderr(1) defines them.\n"
    "  -1      all on one line\n"
    "  -b N    average N by N pixels of both first\n"
    "  -c X    clip both at X times REF's mean\n"
    "  -d N    average N by N pixels of TEST first: it is N times larger\n"
    "  --map=OUT.png           write the difference in false colour\n"
    "  --false-colour=OUT.png  write the luminance in false colour, with a\n"
    "                          legend in cd/m2\n";

struct task {
    struct rad_metric_options metric;
    bool one_line;
    const char *map, *false_colour;
    const char *file[2];
    int nfiles;
};

/* --- the command line ------------------------------------------------------
 */

static int
bad_value(const char *option, const char *what, const char *text,
          struct rad_error *err)
{
    return rad_fail(err, RAD_EUSAGE, "option '%s': expected %s, got '%.40s'",
                    option, what, text);
}

/* "--map=FILE" or "--map FILE": words used, 0 if it is another option. */
static int
file_option(const char *name, const char **file, int argc, char **argv)
{
    size_t n = strlen(name);

    if (strncmp(argv[0], name, n) != 0)
        return 0;
    if (argv[0][n] == '=') {
        *file = argv[0] + n + 1;
        return 1;
    }
    if (argv[0][n] != '\0' || argc < 2)
        return 0;
    *file = argv[1];
    return 2;
}

static int
number_option(struct task *t, int argc, char **argv, struct rad_error *err)
{
    int *field = argv[0][1] == 'b' ? &t->metric.block : &t->metric.down;

    if (argc < 2)
        return rad_fail(err, RAD_EUSAGE, "option '%s': expected a value",
                        argv[0]);
    if (argv[0][1] == 'c') {
        if (!rad_parse_real(argv[1], &t->metric.clip) || t->metric.clip < 0)
            return bad_value("-c", "a number of 0 or more", argv[1], err);
    } else if (!rad_parse_int(argv[1], field) || *field < 1) {
        return bad_value(argv[0], "a whole number above 0", argv[1], err);
    }
    return 2;
}

static int
take_option(struct task *t, int argc, char **argv, struct rad_error *err)
{
    int used;

    if (strcmp(argv[0], "-1") == 0) {
        t->one_line = true;
        return 1;
    }
    if (strcmp(argv[0], "-b") == 0 || strcmp(argv[0], "-c") == 0 ||
        strcmp(argv[0], "-d") == 0)
        return number_option(t, argc, argv, err);
    used = file_option("--map", &t->map, argc, argv);
    if (used == 0)
        used = file_option("--false-colour", &t->false_colour, argc, argv);
    if (used == 0)
        return rad_fail(err, RAD_EUSAGE, "unknown or incomplete option '%.80s'",
                        argv[0]);
    return used;
}

static int
read_options(struct task *t, int argc, char **argv, struct rad_error *err)
{
    int used;

    t->metric.down = t->metric.block = 1;
    for (int i = 1; i < argc; i += used) {
        if (argv[i][0] != '-') {
            if (t->nfiles == 2)
                return rad_fail(err, RAD_EUSAGE, "too many pictures");
            t->file[t->nfiles++] = argv[i];
            used = 1;
        } else if ((used = take_option(t, argc - i, argv + i, err)) < 0) {
            return used;
        }
    }
    if (t->false_colour && (t->nfiles != 1 || t->map))
        return rad_fail(err, RAD_EUSAGE,
                        "--false-colour is of one picture by itself");
    if (!t->false_colour && t->nfiles != 2)
        return rad_fail(err, RAD_EUSAGE, "expected two pictures, got %d",
                        t->nfiles);
    return 0;
}

/* --- pictures --------------------------------------------------------------
 */

static int
read_picture(const char *path, struct rad_picture *pic, struct rad_error *err)
{
    size_t len;
    unsigned char *data = rad_file_read(path, MOST_BYTES, &len, err);
    struct rad_error bad = { 0 };
    char text[400];
    int rc;

    memset(pic, 0, sizeof *pic);
    if (!data)
        return err->code;
    rc = rad_hdr_read(data, len, MOST_PIXELS, pic, &bad);
    free(data);
    if (rc < 0) {
        rad_error_format(&bad, text, sizeof text);
        rad_error_where(err, "%s", path);
        rad_fail(err, rc, "%s", text);
    }
    return rc;
}

static int
write_image(const char *path, const struct rad_image *image,
            struct rad_error *err)
{
    struct rad_memory_out png = { 0 };
    struct rad_sink sink = rad_memory_sink(&png);
    int rc =
        rad_png_write(image->rgb, image->width, image->height, 1, &sink, err);

    if (rc == 0)
        rc = output_write(path, png.bytes, png.len, false, err);
    free(png.bytes);
    return rc;
}

static int
false_colour(const struct task *t, struct rad_error *err)
{
    struct rad_picture pic;
    struct rad_image image = { 0 };
    int rc = read_picture(t->file[0], &pic, err);

    if (rc == 0)
        rc = rad_false_colour(&pic, &image, err);
    if (rc == 0)
        rc = write_image(t->false_colour, &image, err);
    free(image.rgb);
    rad_picture_release(&pic);
    return rc;
}

static void
print_figures(const struct rad_metric *m, bool one_line)
{
    const char *gap = one_line ? "  " : "\n";

    printf("mean_ratio %.6g%snrmse %.6g%slog_rmse %.6g%sp50 %.6g%sp95 %.6g%s"
           "p99.9 %.6g%smax %.6g%smaxabs %.6g\n",
           m->mean_ratio, gap, m->nrmse, gap, m->log_rmse, gap, m->p50, gap,
           m->p95, gap, m->p99_9, gap, m->max, gap, m->maxabs);
}

static int
compare_prepared(const struct task *t, const struct rad_picture *a,
                 const struct rad_picture *b, struct rad_error *err)
{
    struct rad_image image = { 0 };
    struct rad_metric m;
    int rc = rad_metric_compare(a, b, &m, err);

    if (rc == 0 && t->map && (rc = rad_difference_map(a, b, &image, err)) == 0)
        rc = write_image(t->map, &image, err);
    free(image.rgb);
    if (rc == 0)
        print_figures(&m, t->one_line);
    return rc;
}

static int
compare(const struct task *t, struct rad_error *err)
{
    struct rad_picture test, ref = { 0 }, a, b;
    int rc = read_picture(t->file[0], &test, err);

    if (rc == 0)
        rc = read_picture(t->file[1], &ref, err);
    if (rc == 0)
        rc = rad_metric_prepare(&test, &ref, &t->metric, &a, &b, err);
    if (rc == 0) {
        rc = compare_prepared(t, &a, &b, err);
        rad_picture_release(&a);
        rad_picture_release(&b);
    }
    rad_picture_release(&test);
    rad_picture_release(&ref);
    return rc;
}

int
main(int argc, char **argv)
{
    struct rad_error err = { 0 };
    struct task t = { 0 };
    char text[600];
    int rc;

    if (argc > 1 && strcmp(argv[1], "--help") == 0) {
        printf("%s%s", usage_text, help_text);
        return EX_OK;
    }
    if (argc > 1 && strcmp(argv[1], "--version") == 0) {
        printf("raderr %s\n", PACKAGE_VERSION);
        return EX_OK;
    }
    rc = read_options(&t, argc, argv, &err);
    if (rc == 0)
        rc = t.false_colour ? false_colour(&t, &err) : compare(&t, &err);
    if (rc == 0 && fflush(stdout) != 0)
        rc = rad_fail(&err, RAD_EIO, "standard output: write failed");
    if (rc < 0) {
        rad_error_format(&err, text, sizeof text);
        fprintf(stderr, "raderr: %s\n", text);
        if (rc == RAD_EUSAGE)
            fputs(usage_text, stderr);
    }
    return rad_exit_status(rc);
}
