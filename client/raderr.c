/* raderr.c - compares pictures: how far is one from another */
#include "config.h"

#include "common/inputs.h"
#include "common/option.h"
#include "common/outname.h"
#include "common/tell.h"
#include "base/list.h"
#include "base/output.h"
#include "show/picfile.h"
#include "tone/falsecolour.h"
#include "image/metric.h"
#include "image/png.h"
#include "image/spectrum.h"
#include "scene/file/specpict.h"

#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES  ((size_t)1 << 32)
#define MOST_PIXELS ((size_t)1 << 28)

static const char usage_text[] =
    "usage: raderr [-1] [-b N] [-c X] [-d N] [--map=OUT.png] "
    "TEST.hdr REF.hdr\n"
    "       raderr --false-colour=OUT.png [--scale=SCALE] PICTURE.hdr\n"
    "       raderr --mean=OUT.hdr [-d N] PICTURE.hdr...\n"
    "       raderr --help | --version\n";

struct task {
    struct rad_metric_options metric;
    bool one_line;
    const char *map, *false_colour, *mean;
    const char *scale; /* of --false-colour */
    const char **file; /* room for all words of the command line */
    int nfiles;
};

/* --- the command line ------------------------------------------------------
 */

static const struct option options[] = {
    { "-1", OPTION_FLAG, offsetof(struct task, one_line), NULL,
      "all on one line", .with = NULL },
    { "-b", OPTION_INT, offsetof(struct task, metric.block), "N",
      "average N by N pixels of both first", .lo = 1, .hi = INT_MAX },
    { "-c", OPTION_REAL, offsetof(struct task, metric.clip), "X",
      "clip both at X times REF's mean", .lo = 0, .hi = 1e30 },
    { "-d", OPTION_INT, offsetof(struct task, metric.down), "N",
      "average N by N pixels of TEST first: it is N times larger", .lo = 1,
      .hi = INT_MAX },
    { "--map", OPTION_TEXT, offsetof(struct task, map), "OUT.png",
      "write the difference in false colour", .with = NULL },
    { "--false-colour", OPTION_TEXT, offsetof(struct task, false_colour),
      "OUT.png",
      "write the luminance in false colour, with a legend in cd/m2, or lux of "
      "irradiance",
      .with = NULL },
    { "--scale", OPTION_TEXT, offsetof(struct task, scale), "SCALE",
      "of that: auto or a number, and behind it ,log=DECADES ,n=DIVISIONS "
      ",label=TEXT ,contour=lines|bands|steps (auto)",
      .with = NULL },
    { "--mean", OPTION_TEXT, offsetof(struct task, mean), "OUT.hdr",
      "write the mean of the pictures, reduced by -d", .with = NULL },
};

static void
help(void)
{
    printf("%s\nPrints mean_ratio, nrmse, log_rmse, p50, p95, p99.9, max and "
           "maxabs of\nTEST against REF, in units of radiance; raderr(1) "
           "defines them.\n",
           usage_text);
    option_help(options, N_ELEM(options), stdout);
}

static int
take_option(struct task *t, char *const argv[], struct rad_error *err)
{
    const struct option *o = option_find(options, N_ELEM(options), argv[0]);

    if (!o)
        return rad_fail(err, RAD_EUSAGE,
                        "unknown option '%.80s'; see raderr --help", argv[0]);
    return option_take(o, t, argv, err);
}

/* Check the suffixes of outputs: --mean writes RGBE, the others PNG. */
static int
check_names(const struct task *t, struct rad_error *err)
{
    if (t->mean && outname_suffix(t->mean, ".png"))
        return rad_fail(err, RAD_EUSAGE,
                        "'%s': --mean writes a picture in units of radiance: "
                        "use a name in .hdr or .pic",
                        t->mean);
    if (t->mean)
        return picfile_check(t->mean, false, err);
    if (t->map || t->false_colour)
        return picfile_check(t->map ? t->map : t->false_colour, true, err);
    return 0;
}

/* Check that the output is not one of the input files. */
static int
check_apart(const struct task *t, struct rad_error *err)
{
    const char *out = t->map ? t->map : t->mean ? t->mean : t->false_colour;
    const char *option = t->map    ? "--map"
                         : t->mean ? "--mean"
                                   : "--false-colour";
    struct inputs in = { 0 };
    int rc = 0;

    for (int i = 0; i < t->nfiles && out && rc == 0; i++)
        rc = inputs_add(&in, "one of the pictures", t->file[i], err);
    if (rc == 0 && out && inputs_find(&in, out))
        rc = rad_fail(err, RAD_EUSAGE, "'%s' is %s: %s would take its place",
                      out, inputs_find(&in, out), option);
    inputs_release(&in);
    return rc;
}

/* Is an option given that only a comparison has? */
static bool
compares(const struct task *t)
{
    return t->one_line || t->metric.block > 1 || t->metric.clip > 0 ||
           t->metric.down > 1;
}

static int
check_task(const struct task *t, struct rad_error *err)
{
    if ((t->map != NULL) + (t->false_colour != NULL) + (t->mean != NULL) > 1)
        return rad_fail(err, RAD_EUSAGE,
                        "only one of --map, --false-colour and --mean");
    if (t->scale && !t->false_colour)
        return rad_fail(err, RAD_EUSAGE, "--scale is for --false-colour");
    if (t->false_colour && compares(t))
        return rad_fail(err, RAD_EUSAGE,
                        "--false-colour goes with --scale only");
    if (t->false_colour && t->nfiles != 1)
        return rad_fail(err, RAD_EUSAGE,
                        "--false-colour is of one picture by itself");
    if (t->mean && t->nfiles == 0)
        return rad_fail(err, RAD_EUSAGE, "--mean: no picture");
    if (t->mean && (t->one_line || t->metric.block > 1 || t->metric.clip > 0))
        return rad_fail(err, RAD_EUSAGE, "--mean goes with -d only");
    if (!t->false_colour && !t->mean && t->nfiles != 2)
        return rad_fail(err, RAD_EUSAGE,
                        "expected two pictures, got %d; see raderr --help",
                        t->nfiles);
    if (check_names(t, err) < 0)
        return err->code;
    return check_apart(t, err);
}

static int
read_options(struct task *t, int argc, char **argv, struct rad_error *err)
{
    bool before = true; /* "--" */
    int used;

    t->metric.down = t->metric.block = 1;
    t->file = calloc((size_t)argc + 1, sizeof *t->file);
    if (!t->file)
        return rad_fail_memory(err);
    for (int i = 1; i < argc; i += used) {
        used = 1;
        if (!before || argv[i][0] != '-') {
            t->file[t->nfiles++] = argv[i];
        } else if (strcmp(argv[i], "--") == 0) {
            before = false;
        } else if ((used = take_option(t, argv + i, err)) < 0) {
            return used;
        }
    }
    return check_task(t, err);
}

/* --- pictures --------------------------------------------------------------
 */

/* The product of the numbers in all lines "NAME=number" of the header. */
static double
header_factor(const char *header, const char *name)
{
    double product = 1;
    size_t n = strlen(name);

    for (const char *at = header; (at = strstr(at, name)); at += n)
        if (at > header && at[-1] == '\n')
            product *= strtod(at + n, NULL);
    return product;
}

/* The header of a file of spectra, to be freed; NULL: the file has none. */
static char *
spectra_header(const unsigned char *data, size_t len)
{
    size_t n = 1;
    char *header;

    while (n < len && n < 65536 && !(data[n - 1] == '\n' && data[n] == '\n'))
        n++;
    header = strndup((const char *)data, n);
    if (header && strstr(header, "\nFORMAT=Radiance_spectra"))
        return header;
    free(header);
    return NULL;
}

/* Make a picture of the spectra d as the eye sees them.  d has three
 * dimensions: up, right, wavelength. */
static int
see(const struct rad_data *d, double exposure, struct rad_arena *arena,
    struct rad_picture *pic, struct rad_error *err)
{
    struct rad_bands colours = rad_bands_rgb();
    const struct rad_spectrum *eye;
    double begin[3], length[3], at[3], step;
    int n[3];

    for (int k = 0; k < 3; k++)
        rad_data_axis(d, k, &begin[k], &length[k], &n[k]);
    step = length[2] / (n[2] - 1);
    eye = rad_spectrum_new(arena, n[2], begin[2] - .5 * step,
                           begin[2] + length[2] + .5 * step, &colours);
    pic->height = n[0];
    pic->width = n[1];
    pic->pixaspect = 1;
    pic->L = calloc((size_t)n[0] * (size_t)n[1], sizeof *pic->L);
    if (!eye || !pic->L)
        return rad_fail_memory(err);
    for (int y = 0; y < n[0]; y++)
        for (int x = 0; x < n[1]; x++) {
            double sum[3] = { 0 };

            at[0] = n[0] > 1 ? (n[0] - 1 - y) * length[0] / (n[0] - 1) : 0;
            at[1] = n[1] > 1 ? x * length[1] / (n[1] - 1) : 0;
            for (int i = 0; i < n[2]; i++) {
                at[2] = begin[2] + i * step;
                rad_spectrum_add(eye, i, rad_data_value(d, at) / exposure, sum);
            }
            rad_spectrum_colour(eye, sum);
            pic->L[(size_t)y * (size_t)n[1] + (size_t)x] =
                rad_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
        }
    return 0;
}

static int
read_spectra(const unsigned char *data, size_t len, const char *header,
             struct rad_picture *pic, struct rad_error *err)
{
    double exposure = header_factor(header, "EXPOSURE=");
    struct rad_arena arena;
    const struct rad_data *d;
    int rc = RAD_EDATA;

    if (!(exposure > 0 && exposure < 1e30))
        return rad_fail(err, RAD_EDATA, "picture: bad EXPOSURE");
    rad_arena_init(&arena);
    d = rad_specpict_parse(&arena, data, len, err);
    if (d)
        rc = see(d, exposure, &arena, pic, err);
    if (rc < 0)
        rad_picture_release(pic);
    rad_arena_release(&arena);
    return rc;
}

static int
read_any(const unsigned char *data, size_t len, struct rad_picture *pic,
         struct rad_error *err)
{
    char *header = spectra_header(data, len);
    int rc = header ? read_spectra(data, len, header, pic, err)
                    : rad_hdr_read(data, len, MOST_PIXELS, pic, err);

    free(header);
    return rc;
}

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
    rc = read_any(data, len, pic, &bad);
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
        rc = rad_output_write(path, png.bytes, png.len, false, err);
    free(png.bytes);
    return rc;
}

static int
false_colour(const struct task *t, struct rad_error *err)
{
    struct rad_picture pic;
    struct rad_image image = { 0 };
    struct rad_false_scale scale;
    int rc = rad_false_parse(&scale, t->scale ? t->scale : "", err);

    memset(&pic, 0, sizeof pic);
    if (rc == 0)
        rc = read_picture(t->file[0], &pic, err);
    if (rc == 0) {
        rad_false_fit(&scale, &pic);
        rc = rad_false_colour(&scale, &pic, &image, err);
    }
    if (rc == 0)
        rc = write_image(t->false_colour, &image, err);
    free(image.rgb);
    rad_picture_release(&pic);
    return rc;
}

/* --- the mean of several pictures ----------------------------------------- */

struct sum {
    int width, height, n;
    double pixaspect;
    double *rgb; /* width * height * 3 */
};

/* Add a picture; the first one sets the size. */
static int
sum_add(struct sum *sum, const struct rad_picture *pic, struct rad_error *err)
{
    size_t n = rad_picture_pixels(pic);

    if (!sum->rgb) {
        sum->rgb = calloc(n, 3 * sizeof *sum->rgb);
        if (!sum->rgb)
            return rad_fail_memory(err);
        sum->width = pic->width;
        sum->height = pic->height;
        sum->pixaspect = pic->pixaspect;
    }
    if (pic->width != sum->width || pic->height != sum->height)
        return rad_fail(err, RAD_EDATA, "sizes differ: %dx%d and %dx%d",
                        pic->width, pic->height, sum->width, sum->height);
    for (size_t i = 0; i < n; i++) {
        sum->rgb[3 * i] += pic->L[i].r;
        sum->rgb[3 * i + 1] += pic->L[i].g;
        sum->rgb[3 * i + 2] += pic->L[i].b;
    }
    sum->n++;
    return 0;
}

static int
sum_file(struct sum *sum, const char *path, int down, struct rad_error *err)
{
    struct rad_picture pic, small;
    int rc = read_picture(path, &pic, err);

    if (rc == 0 && down > 1) {
        if (pic.width % down || pic.height % down)
            rc = rad_fail(err, RAD_EDATA, "%dx%d is not a multiple of %d",
                          pic.width, pic.height, down);
        else
            rc = rad_picture_blocks(&pic, down, &small, err);
        rad_picture_release(&pic);
        if (rc == 0)
            pic = small;
    }
    if (rc == 0)
        rc = sum_add(sum, &pic, err);
    if (rc < 0)
        rad_error_where(err, "%s", path);
    rad_picture_release(&pic);
    return rc;
}

static int
encode_mean(const struct sum *sum, const struct rad_sink *sink,
            struct rad_error *err)
{
    struct rad_hdr_info info = { .software = "radd " PACKAGE_VERSION,
                                 .program = "raderr",
                                 .options = "--mean",
                                 .pixaspect = sum->pixaspect,
                                 .width = sum->width,
                                 .height = sum->height };
    size_t width = (size_t)sum->width;
    struct rad_rgb *row = malloc(width * sizeof *row);
    uint8_t *code = malloc(RAD_HDR_ROW_BYTES(width));
    int rc = row && code ? rad_hdr_write_header(&info, sink, err)
                         : rad_fail_memory(err);

    for (int y = 0; rc == 0 && y < sum->height; y++) {
        const double *rgb = sum->rgb + 3 * width * (size_t)y;

        for (size_t x = 0; x < width; x++, rgb += 3)
            row[x] = rad_rgb((float)(rgb[0] / sum->n), (float)(rgb[1] / sum->n),
                             (float)(rgb[2] / sum->n));
        rc = sink->write(sink->arg, code,
                         rad_hdr_encode_row(row, sum->width, code), err);
    }
    free(row);
    free(code);
    return rc;
}

static int
mean_pictures(const struct task *t, struct rad_error *err)
{
    struct sum sum = { 0 };
    struct rad_memory_out out = { 0 };
    struct rad_sink sink = rad_memory_sink(&out);
    int rc = 0;

    for (int i = 0; rc == 0 && i < t->nfiles; i++)
        rc = sum_file(&sum, t->file[i], t->metric.down, err);
    if (rc == 0)
        rc = encode_mean(&sum, &sink, err);
    if (rc == 0)
        rc = rad_output_write(t->mean, out.bytes, out.len, false, err);
    free(out.bytes);
    free(sum.rgb);
    return rc;
}

/* --- two pictures ----------------------------------------------------------
 */

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
    struct rad_metric m = { 0 };
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
    int rc = 0;

    rad_output_guard();
    if (argc > 1 && strcmp(argv[1], "--help") == 0)
        help();
    else if (argc > 1 && strcmp(argv[1], "--version") == 0)
        puts("raderr (radd) " PACKAGE_VERSION);
    else if ((rc = read_options(&t, argc, argv, &err)) == 0)
        rc = t.mean           ? mean_pictures(&t, &err)
             : t.false_colour ? false_colour(&t, &err)
                              : compare(&t, &err);
    if (rc == 0)
        rc = tell_printed(&err);
    free(t.file);
    if (rc < 0) {
        rad_error_format(&err, text, sizeof text);
        fprintf(stderr, "raderr: %s\n", text);
    }
    return rad_exit_status(rc);
}
