/* check_ambfile.c - files of ambient records: ours lose nothing, those in
 * Radiance's format what that has no room for; files that do not fit are
 * refused */
#include "config.h"

#include "records/ambfile.h"
#include "proto/ambshare.h"
#include "base/files.h"
#include "tests/world.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROOM                                                                   \
    "void plastic grey 0 0 5 .5 .4 .3 0 0\n"                                   \
    "void light lamp 0 0 3 9 9 9\n"                                            \
    "lamp sphere a 0 0 4 0 0 .5 .1\n"                                          \
    "grey bubble b 0 0 4 0 0 0 1\n"
#define OPTIONS "-ab 2 -aa .2 -ar 32 -ad 64 -as 32"
#define SCENE   "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

static void
look(struct world *w, int n)
{
    for (int i = 0; i < n; i++) {
        double p[3] = { .1 * i - .4, .2, -.7 }, up[3] = { 0, 0, 1 };
        struct rad_ray r;

        rad_ray_irradiance(&w->ctx, &r, p, up, (uint64_t)i);
    }
}

static struct ambfile
file_of(const struct world *w, enum ambfile_format format)
{
    struct ambfile a = { .format = format,
                         .params = w->params,
                         .scene = SCENE };

    return a;
}

struct taken {
    struct rad_ambrec rec[4096];
    size_t n;
};
static struct taken taken, listed;

/* Parse a file and add its records to `taken`. */
static int
parse(struct ambfile *a, const void *file, size_t n, struct rad_error *err)
{
    struct wire_out list;
    struct wire_in in;
    int rc;

    wire_out_init(&list, 4096 * AMBSHARE_BYTES);
    rc = ambfile_parse(a, file, n, &list, err);
    wire_in_init(&in, list.buf, list.len);
    while (wire_left(&in) > 0) {
        ck_assert_uint_lt(taken.n, 4096);
        ck_assert(ambshare_unpack(&in, &taken.rec[taken.n++]));
    }
    wire_out_release(&list);
    return rc;
}

/* `listed` as it travels. */
static struct wire_out
pack_listed(void)
{
    struct wire_out list;

    wire_out_init(&list, 4096 * AMBSHARE_BYTES);
    for (size_t i = 0; i < listed.n; i++)
        ambshare_pack(&list, &listed.rec[i]);
    return list;
}

/* A world whose records are listed, and the bytes of a file that has them;
 * another world to read them. */
static struct world w, v;
static char *bytes;
static size_t len;

static void
set_up(void)
{
    uint64_t cursor = 0;

    world_open(&w, ROOM, OPTIONS);
    look(&w, 9);
    listed.n = rad_ambient_list(w.job->ambient, &cursor, listed.rec, 4096);
    ck_assert_uint_gt(listed.n, 10);
    taken.n = 0;
}

static void
tear_down(void)
{
    free(bytes);
    bytes = NULL;
    world_close(&w);
    world_close(&v);
}

FIXTURE(set_up, tear_down)

static void
write_file(enum ambfile_format format)
{
    struct ambfile a = file_of(&w, format);
    FILE *f = open_memstream(&bytes, &len);
    struct wire_out list = pack_listed();

    ck_assert_ptr_nonnull(f);
    ck_assert_int_eq(ambfile_format(&a, list.buf, list.len, f, NULL), 0);
    ck_assert_int_eq(fclose(f), 0);
    wire_out_release(&list);
}

/* Take the file's records by the options of that world; returns its format. */
static enum ambfile_format
read_file(const struct world *by, enum ambfile_format format)
{
    struct ambfile b = file_of(by, format);
    struct rad_error err = { 0 };

    ck_assert_msg(parse(&b, bytes, len, &err) == 0, "%s", err.what);
    return b.format;
}

TEST(our_file_loses_nothing)
{
    write_file(AMBFILE_OURS);
    ck_assert_int_eq(read_file(&w, AMBFILE_RADIANCE), AMBFILE_OURS);
    ck_assert_uint_eq(taken.n, listed.n);
    for (size_t i = 0; i < taken.n; i++) {
        ck_assert_mem_eq(taken.rec[i].p, listed.rec[i].p, sizeof(double[3]));
        ck_assert_mem_eq(&taken.rec[i].E, &listed.rec[i].E,
                         sizeof(struct rad_rgb));
        ck_assert_float_eq(taken.rec[i].var, listed.rec[i].var);
        ck_assert_mem_eq(&taken.rec[i].glint, &listed.rec[i].glint,
                         sizeof(struct rad_glint));
        ck_assert_uint_eq(taken.rec[i].corral, listed.rec[i].corral);
        ck_assert_uint_eq(taken.rec[i].level, listed.rec[i].level);
    }
}

static void
ck_near(const float *a, const float *b, int n, double tol)
{
    for (int i = 0; i < n; i++)
        ck_assert_double_eq_tol((double)a[i], (double)b[i],
                                tol * (1 + fabs((double)b[i])));
}

TEST(radiance_file_keeps_what_it_has_room_for)
{
    write_file(AMBFILE_RADIANCE);
    ck_assert_int_eq(read_file(&w, AMBFILE_OURS), AMBFILE_RADIANCE);
    ck_assert_uint_eq(taken.n, listed.n);
    for (size_t i = 0; i < taken.n; i++) {
        const struct rad_ambrec *got = &taken.rec[i], *put = &listed.rec[i];

        for (int k = 0; k < 3; k++)
            ck_assert_double_eq_tol(got->p[k], put->p[k], 1e-8);
        ck_near(got->n, put->n, 3, 2e-4);
        ck_near(got->u, put->u, 3, 4e-4);
        ck_near(got->radius, put->radius, 2, 1e-6);
        ck_near(got->gpos, put->gpos, 2, 1e-6);
        ck_near(got->gdir, put->gdir, 2, 1e-6);
        ck_near(&got->E.r, &put->E.r, 3, .02);
        ck_near(&got->weight, &put->weight, 1, 1e-6);
        ck_assert_float_eq(got->var, RAD_AMBREC_UNSURE);
        ck_assert_uint_eq(got->corral, put->corral);
        ck_assert_uint_eq(got->level, put->level);
    }
}

/* A file of the other scene or options, or a part of one; each row spoils one
 * thing and names what is said. */
static const struct {
    const char *options, *scene;
    size_t cut;
    enum ambfile_format format;
    const char *what;
} bad[] = {
    { OPTIONS " -ad 128", SCENE, 0, AMBFILE_OURS, "-ad differs" },
    { OPTIONS " -dt .1", SCENE, 0, AMBFILE_OURS, "-dt differs" },
    { OPTIONS, "f" SCENE, 0, AMBFILE_OURS, "another scene" },
    { OPTIONS, SCENE, 1, AMBFILE_OURS, "in the middle" },
    { OPTIONS, SCENE, SIZE_MAX, AMBFILE_OURS, "not a file of" },
    { OPTIONS " -ad 128", SCENE, 0, AMBFILE_RADIANCE, "-ad 64, not 128" },
    { OPTIONS " -ab 3", SCENE, 0, AMBFILE_RADIANCE, "-ab 2, not 3" },
    { OPTIONS, SCENE, 1, AMBFILE_RADIANCE, "in the middle" },
};

LOOP_TEST(what_does_not_fit_is_refused, N_ELEM(bad))
{
    struct rad_error err = { 0 };
    struct ambfile b;

    write_file(bad[_i].format);
    world_open(&v, ROOM, bad[_i].options);
    b = file_of(&v, AMBFILE_OURS);
    snprintf(b.scene, sizeof b.scene, "%s", bad[_i].scene);
    ck_assert_int_eq(parse(&b, bytes,
                           bad[_i].cut == SIZE_MAX ? 50 : len - bad[_i].cut,
                           &err),
                     RAD_EDATA);
    ck_assert_msg(strstr(err.what, bad[_i].what) != NULL, "%s", err.what);
    ck_assert_uint_eq(taken.n, 0);
}

/* Files that begin as ours do and hold something else, such as a picture, which
 * a run would write its records over. */
static const char *const others[] = {
    "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n",
    "#?RADIANCE\nSCENE=" SCENE "\nOPTIONS=-ab 2\n\n",
    "#?RADIANCE\nFORMAT=radd_ambient_3\nOPTIONS=-ab 2\n\n",
    "#?RADIANCE\nFORMAT=radd_ambient_3\nSCENE=" SCENE "\n\n",
};

LOOP_TEST(another_file_is_none_of_records, N_ELEM(others))
{
    struct rad_error err = { 0 };
    struct ambfile b;

    world_open(&v, ROOM, OPTIONS);
    b = file_of(&v, AMBFILE_OURS);
    ck_assert_int_eq(parse(&b, others[_i], strlen(others[_i]), &err),
                     RAD_EDATA);
    ck_assert_str_eq(err.what, "not a file of ambient records");
}

/* How pixels are placed does not matter. */
TEST(other_pixels_use_the_same_records)
{
    write_file(AMBFILE_OURS);
    world_open(&v, ROOM, OPTIONS " -x 99 -pa 0 -ps 1 -pj .5 -pt .2");
    read_file(&v, AMBFILE_OURS);
    ck_assert_uint_gt(taken.n, 0);
}

/* Written once and read again, nothing is left to be sampled; at first the file
 * is missing, or empty as mktemp(1) makes it. */
LOOP_TEST(second_run_makes_no_records, 2)
{
    char path[] = "check_ambfile.XXXXXX";
    int fd = mkstemp(path);
    struct rad_error err = { 0 };

    ck_assert_int_ge(fd, 0);
    close(fd);
    if (_i == 0)
        unlink(path);
    for (int run = 0; run < 2; run++) {
        struct ambfile a;

        world_open(&v, ROOM, OPTIONS);
        a = file_of(&v, AMBFILE_OURS);
        ck_assert_msg(ambfile_load(&a, path, v.job->ambient, &err) == 0, "%s",
                      err.what);
        look(&v, 9);
        ck_assert(run == 0 ? v.ctx.counts.ambient_values > 0
                           : v.ctx.counts.ambient_values == 0);
        ck_assert_msg(ambfile_save(&a, path, v.job->ambient, &err) == 0, "%s",
                      err.what);
    }
    unlink(path);
}

TEST(records_of_another_place_are_refused)
{
    char path[] = "check_ambfile.XXXXXX";
    int fd = mkstemp(path);
    struct rad_error err = { 0 };
    struct ambfile a = file_of(&w, AMBFILE_RADIANCE);

    ck_assert_int_ge(fd, 0);
    close(fd);
    ck_assert_int_eq(ambfile_save(&a, path, w.job->ambient, &err), 0);
    world_open(&v,
               "void plastic grey 0 0 5 .5 .4 .3 0 0\n"
               "grey sphere b 0 0 4 9 0 0 .1\n",
               OPTIONS);
    ck_assert_int_eq(ambfile_load(&a, path, v.job->ambient, &err), RAD_EDATA);
    ck_assert_msg(strstr(err.what, "fits the scene") != NULL, "%s", err.what);
    ck_assert_str_eq(err.where, path);
    unlink(path);
}

/* rtrace makes such records for sensors outside of the scene */
TEST(records_outside_are_left_out)
{
    struct rad_error err = { 0 };
    struct wire_out all;

    wire_out_init(&all, 1 << 20);
    for (size_t i = 0; i < listed.n; i++) {
        struct rad_ambrec far = listed.rec[i];

        far.p[2] += 100;
        ambshare_pack(&all, &listed.rec[i]);
        ambshare_pack(&all, &far);
    }
    world_open(&v, ROOM, OPTIONS);
    ck_assert_msg(ambshare_load(v.job->ambient, all.buf, all.len, &err) == 0,
                  "%s", err.what);
    ck_assert_uint_eq(rad_ambient_count(v.job->ambient), listed.n);
    wire_out_release(&all);
}

/* A cache becomes the same file as a list of its records; it takes a list
 * whole, or says what is wrong. */
TEST(a_list_is_as_good_as_a_cache)
{
    char path[] = "check_ambfile.XXXXXX";
    int fd = mkstemp(path);
    struct rad_error err = { 0 };
    struct wire_out list = pack_listed();
    struct ambfile a = file_of(&w, AMBFILE_OURS);
    unsigned char *saved;
    size_t n;

    write_file(AMBFILE_OURS);
    ck_assert_int_ge(fd, 0);
    close(fd);
    ck_assert_int_eq(ambfile_save(&a, path, w.job->ambient, &err), 0);
    saved = rad_file_read(path, SIZE_MAX / 2, &n, &err);
    unlink(path);
    ck_assert_ptr_nonnull(saved);
    ck_assert_uint_eq(len, n);
    ck_assert_mem_eq(bytes, saved, len);
    free(saved);

    world_open(&v, ROOM, OPTIONS);
    ck_assert_int_eq(ambshare_load(v.job->ambient, list.buf, list.len, &err),
                     0);
    ck_assert_uint_eq(rad_ambient_count(v.job->ambient), listed.n);
    ck_assert_uint_eq(rad_ambient_drain(v.job->ambient, taken.rec, 4096), 0);
    look(&v, 9);
    ck_assert_uint_eq(v.ctx.counts.ambient_values, 0);
    ck_assert_int_eq(ambshare_load(v.job->ambient, list.buf, 93, &err),
                     RAD_EDATA);
    ck_assert_msg(strstr(err.what, "in the middle") != NULL, "%s", err.what);
    err = (struct rad_error){ 0 };
    world_open(&v,
               "void plastic grey 0 0 5 .5 .4 .3 0 0\n"
               "grey sphere b 0 0 4 9 0 0 .1\n",
               OPTIONS);
    ck_assert_int_eq(ambshare_load(v.job->ambient, list.buf, list.len, &err),
                     RAD_EDATA);
    ck_assert_msg(strstr(err.what, "fits the scene") != NULL, "%s", err.what);
    wire_out_release(&list);
}
