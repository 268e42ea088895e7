/* check_rows.c - rows of a picture on the disk, and pictures and previews made
 * of them */
#include "config.h"

#include "machine/action.h"
#include "folder/filtered.h"
#include "folder/rows.h"
#include "ground/sanitized.h"
#include "image/hdr.h"
#include "rows_fixture.h"
#include "tests/scratch.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

FIXTURE(scratch_make, scratch_remove)

static void
put(struct rows *r, int x, int y, int w, int h)
{
    float px[W * H * 4];

    for (int j = 0; j < h; j++)
        for (int i = 0; i < w; i++)
            for (int c = 0; c < (int)r->kind; c++)
                px[(j * w + i) * (int)r->kind + c] = value(x + i, y + j, c);
    ck_assert_int_eq(rows_write(r, (struct rows_area){ x, y, w, h }, px, NULL),
                     0);
}

static struct rows_open opened;

static void
create(struct rows *r, struct rows_open *among, const char *path,
       struct rows_form form)
{
    ck_assert_int_eq(rows_create(r, among, path, form, NULL), 0);
}

/* Use others until none of before is open. */
static void
push_out(void)
{
    struct rows other[ROWS_OPEN];
    char path[160];

    for (int i = 0; i < ROWS_OPEN; i++) {
        snprintf(path, sizeof path, "%s/other.%d", dir, i);
        create(&other[i], &opened, path,
               (struct rows_form){ W, H, ROWS_COLOURS, false });
        put(&other[i], 0, 0, W, 1);
    }
    for (int i = 0; i < ROWS_OPEN; i++)
        rows_remove(&other[i]);
}

static void
make_rows(struct rows *r, enum rows_kind kind)
{
    char path[160];

    snprintf(path, sizeof path, "%s/f.rows", dir);
    create(r, &opened, path, (struct rows_form){ W, H, kind, true });
}

RANGE_TEST(windows_make_a_whole, 3, 5)
{
    struct rows r;
    float line[W * 4];

    make_rows(&r, (enum rows_kind)_i);
    put(&r, 0, 0, 4, 3);
    put(&r, 4, 0, 6, 3);
    push_out();
    put(&r, 0, 3, W, 2);
    ck_assert_int_eq(rows_sync(&opened, NULL), 0);
    for (int y = 0; y < 5; y++) {
        ck_assert_int_eq(rows_read(&r, y, line, NULL), 0);
        for (int x = 0; x < W; x++)
            for (int c = 0; c < _i; c++)
                ck_assert_float_eq(line[x * _i + c], value(x, y, c));
    }
    ck_assert_int_eq(rows_read(&r, 5, line, NULL), 0);
    for (int i = 0; i < W * _i; i++)
        ck_assert_float_eq(line[i], 0); /* has not come */
    rows_remove(&r);
}

static int
open_files(void)
{
    DIR *d = opendir("/proc/self/fd");
    int n = 0;

    ck_assert_ptr_nonnull(d);
    while (readdir(d))
        n++;
    closedir(d);
    return n;
}

TEST(few_of_many_files_are_open)
{
    enum { MANY = 100 };
    static struct rows r[MANY];
    int before = open_files();
    float line[W * 4];
    char path[160];

    for (int i = 0; i < MANY; i++) {
        snprintf(path, sizeof path, "%s/%d.rows", dir, i);
        create(&r[i], &opened, path,
               (struct rows_form){ W, H, ROWS_COLOURS, true });
        put(&r[i], 0, i % H, W, 1);
    }
    ck_assert_int_le(open_files(), before + ROWS_OPEN);
    ck_assert_int_eq(rows_sync(&opened, NULL), 0);
    for (int i = 0; i < MANY; i++) {
        ck_assert(!r[i].dirty);
        ck_assert_int_eq(rows_read(&r[i], i % H, line, NULL), 0);
        ck_assert_float_eq(line[3], value(1, i % H, 0));
    }
    for (int i = 0; i < MANY; i++)
        rows_remove(&r[i]);
    ck_assert_int_eq(open_files(), before);
    ck_assert_ptr_null(opened.file[0]);
}

static bool no_memory;

/* In place of the C library's. */
char *
strdup(const char *text)
{
    size_t n = strlen(text) + 1;
    char *copy = no_memory ? NULL : malloc(n);

    return copy ? memcpy(copy, text, n) : NULL;
}

TEST(a_file_whose_sync_cannot_be_noted_stays_open)
{
    static struct rows r[ROWS_OPEN + 1];
    float px[W * 3] = { 0 };
    char path[160];

    for (int i = 0; i <= ROWS_OPEN; i++) {
        snprintf(path, sizeof path, "%s/%d.rows", dir, i);
        create(&r[i], &opened, path,
               (struct rows_form){ W, H, ROWS_COLOURS, true });
        if (i < ROWS_OPEN)
            put(&r[i], 0, 0, W, 1);
    }
    no_memory = true;
    ck_assert_int_eq(
        rows_write(&r[ROWS_OPEN], (struct rows_area){ 0, 0, W, 1 }, px, NULL),
        RAD_ENOMEM);
    no_memory = false;
    ck_assert(r[0].dirty);
    put(&r[ROWS_OPEN], 0, 0, W, 1);
    ck_assert_int_eq(rows_sync(&opened, NULL), 0);
    for (int i = 0; i <= ROWS_OPEN; i++)
        rows_remove(&r[i]);
}

static const struct rows_area outside[] = {
    { -1, 0, 1, 1 },    { 0, -1, 1, 1 },         { 0, 0, W + 1, 1 },
    { 0, 0, 1, H + 1 }, { W, 0, 1, 1 },          { 0, H, 1, 1 },
    { 0, 0, 0, 1 },     { 3, 3, 2000000000, 1 },
};

LOOP_TEST(pixels_outside_are_refused, N_ELEM(outside))
{
    struct rows r;
    float px[W * H * 4] = { 0 };

    make_rows(&r, ROWS_COLOURS);
    ck_assert_int_eq(rows_write(&r, outside[_i], px, NULL), RAD_EPROTO);
    rows_remove(&r);
}

static unsigned char *
slurp(const char *path, size_t *n)
{
    struct rad_error err = { 0 };
    unsigned char *p = rad_file_read(path, 1 << 20, n, &err);

    ck_assert_msg(p != NULL, "%s", err.what);
    return p;
}

TEST(picture_and_depth_hold_the_rows)
{
    struct rad_hdr_info info = { .program = "radsubmit",
                                 .options = "-ab 0",
                                 .view = "-vtv",
                                 .pixaspect = 1,
                                 .width = W,
                                 .height = H };
    struct rad_picture pic;
    struct rows r;
    char path[160];
    struct rows_output lasting = { .path = path, .durable = true };
    unsigned char *data;
    float z;
    size_t n;

    make_rows(&r, ROWS_DISTANCES);
    put(&r, 0, 0, W, H);
    snprintf(path, sizeof path, "%s/f.hdr", dir);
    ck_assert_int_eq(rows_picture(&r, &info, &lasting, NULL), 0);
    data = slurp(path, &n);
    ck_assert_int_eq(rad_hdr_read(data, n, 1000, &pic, NULL), 0);
    ck_assert_int_eq(pic.width, W);
    ck_assert_int_eq(pic.height, H);
    for (int y = 0; y < H; y++) /* a mantissa has eight bits */
        for (int x = 0; x < W; x++)
            ck_assert_float_eq_tol(pic.L[y * W + x].r, value(x, y, 0),
                                   value(x, y, 2) / 128);
    rad_picture_release(&pic);
    free(data);
    snprintf(path, sizeof path, "%s/f.z", dir);
    ck_assert_int_eq(rows_depth(&r, 1, false, &lasting, NULL), 0);
    data = slurp(path, &n);
    ck_assert_uint_eq(n, W * H * sizeof(float));
    memcpy(&z, data + (3 * W + 2) * sizeof z, sizeof z);
    ck_assert_float_eq(z, value(2, 3, 3));
    free(data);
    rows_remove(&r);
}

static int
write_code(struct rows *r, int x, int y, int w, int h, const uint8_t *code,
           size_t n, uint64_t *sum)
{
    return rows_write_coded(r, (struct rows_area){ x, y, w, h },
                            (struct rows_code){ code, n }, sum, NULL);
}

static int
put_coded(struct rows *r, int x, int y, int w, int h)
{
    uint8_t code[H * RAD_HDR_ROW_BYTES(W)];
    size_t n = code_rows(x, y, w, h, code);

    return write_code(r, x, y, w, h, code, n, NULL);
}

static const struct {
    enum rows_kind kind;
    bool durable;
    int split; /* the first column of a second window; W: there is none */
} codings[] = {
    { ROWS_CODED, false, W },
    { ROWS_RGBE, true, W },
    { ROWS_RGBE, false, 3 },
    { ROWS_COLOURS, true, W },
};

/* Coded rows in any order, some in one piece, one of them twice. */
LOOP_TEST(coded_rows_make_the_picture_of_the_others, N_ELEM(codings))
{
    struct rad_hdr_info info = { .program = "radsubmit",
                                 .options = "-ab 0",
                                 .pixaspect = 1,
                                 .width = W,
                                 .height = H };
    static const int order[][2] = { { 3, 2 }, { 0, 2 }, { 3, 2 } };
    enum rows_kind kind = codings[_i].kind;
    unsigned char *data[2];
    int split = codings[_i].split;
    char path[160];
    struct rows_output out = { .path = path };
    struct rows r;
    size_t n[2];

    for (int coded = 0; coded < 2; coded++) {
        snprintf(path, sizeof path, "%s/f.rows", dir);
        create(&r, &opened, path,
               (struct rows_form){ W, H, coded ? kind : ROWS_COLOURS,
                                   codings[_i].durable });
        for (int i = 0; i < N_ELEM(order); i++) {
            int y = order[i][0], h = order[i][1], rc;

            if (!coded) {
                put(&r, 0, y, W, h);
                continue;
            }
            rc = put_coded(&r, 0, y, split, h);
            ck_assert_int_eq(rc, kind == ROWS_COLOURS ? RAD_EPROTO : 0);
            if (split < W)
                ck_assert_int_eq(put_coded(&r, split, y, W - split, h), 0);
            push_out();
        }
        if (coded && kind == ROWS_COLOURS) {
            rows_remove(&r);
            free(data[0]);
            return;
        }
        snprintf(path, sizeof path, "%s/f.hdr", dir);
        ck_assert_int_eq(rows_picture(&r, &info, &out, NULL), 0);
        data[coded] = slurp(path, &n[coded]);
        rows_remove(&r);
    }
    ck_assert_uint_eq(n[0], n[1]);
    ck_assert_mem_eq(data[0], data[1], n[0]);
    free(data[0]);
    free(data[1]);
}

RANGE_TEST(coded_rows_that_are_none_are_refused, ROWS_CODED, ROWS_RGBE + 1)
{
    uint8_t code[2 * RAD_HDR_ROW_BYTES(W)], work[ROWS_WORK_BYTES(W)];
    uint8_t rgbe[4 * W], black[4 * W] = { 0 };
    size_t n = code_rows(0, 0, W, 1, code);
    char path[160];
    struct rows r;

    snprintf(path, sizeof path, "%s/f.rows", dir);
    ck_assert_int_eq(rows_create(&r, &opened, path,
                                 (struct rows_form){ W, H, ROWS_CODED, true },
                                 NULL),
                     RAD_EINTERNAL);
    create(&r, &opened, path,
           (struct rows_form){ W, H, (enum rows_kind)_i, false });
    ck_assert_int_eq(write_code(&r, 0, H, W, 1, code, n, NULL), RAD_EPROTO);
    ck_assert_int_eq(write_code(&r, 0, -1, W, 1, code, n, NULL), RAD_EPROTO);
    ck_assert_int_eq(write_code(&r, 1, 0, W, 1, code, n, NULL), RAD_EPROTO);
    ck_assert_int_eq(write_code(&r, 0, 0, W, 2, code, n, NULL), RAD_EPROTO);
    ck_assert_int_eq(rows_read_rgbe(&r, 0, rgbe, work, NULL), 0);
    ck_assert_mem_eq(rgbe, black, sizeof rgbe); /* nor a part of those */
    ck_assert_int_eq(write_code(&r, 0, 0, W, 1, code, n + 1, NULL), RAD_EPROTO);
    ck_assert_int_eq(write_code(&r, 0, 0, W, 1, code, n - 1, NULL), RAD_EPROTO);
    ck_assert_int_eq(write_code(&r, 0, 0, W - 1, 1, code, n, NULL), RAD_EPROTO);
    ck_assert_int_eq(write_code(&r, 0, 0, W, 1, code, n, NULL), 0);
    rows_remove(&r);
}

/* The memory that this process may have beyond what it has; 0: any. */
static void
limit_memory(rlim_t more)
{
    struct rlimit limit;
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");

    ck_assert(f && fscanf(f, "%lu", &pages) == 1);
    fclose(f);
    ck_assert_int_eq(getrlimit(RLIMIT_AS, &limit), 0);
    limit.rlim_cur =
        more ? pages * (rlim_t)sysconf(_SC_PAGESIZE) + more : limit.rlim_max;
    ck_assert_int_eq(setrlimit(RLIMIT_AS, &limit), 0);
}

/* 256 kB of runs stand for 16 MiB of pixels.  Their sum is that of any pieces.
 */
TEST(coded_rows_are_taken_apart_a_few_at_a_time)
{
    enum { WIDE = 32767, MANY = 128 };
    uint8_t *code = malloc(MANY * RAD_HDR_ROW_BYTES(WIDE));
    struct rad_rgb *line = calloc(WIDE, sizeof *line);
    uint64_t sum = 0, part, pieces = 0;
    size_t n = 0, at[MANY + 1];
    char path[160];
    struct rows r;

    ck_assert(code && line);
    for (int y = 0; y < MANY; y++) {
        at[y] = n;
        for (int x = 0; x < WIDE; x++)
            line[x] = rad_rgb((float)y, 1, 1);
        n += rad_hdr_encode_row(line, WIDE, code + n);
    }
    at[MANY] = n;
    ck_assert_uint_lt(n, 512 << 10);
    snprintf(path, sizeof path, "%s/f.rows", dir);
    create(&r, &opened, path,
           (struct rows_form){ WIDE, MANY, ROWS_RGBE, false });
    if (!RAD_SANITIZED) /* a sanitizer's shadow is memory, too */
        limit_memory(8 << 20);
    ck_assert_int_eq(write_code(&r, 0, 0, WIDE, MANY, code, n, &sum), 0);
    limit_memory(0);
    for (int y = 0; y < MANY; y++) {
        ck_assert_int_eq(write_code(&r, 0, y, WIDE, 1, code + at[y],
                                    at[y + 1] - at[y], &part),
                         0);
        pieces ^= part;
    }
    ck_assert_uint_ne(sum, 0);
    ck_assert_uint_eq(sum, pieces);
    rows_remove(&r);
    free(code);
    free(line);
}

/* To the bit, in another life too, and beside the coded rows. */
TEST(a_line_keeps_its_floats)
{
    float line[3 * W], back[3 * W];
    struct rows r, again;

    for (int i = 0; i < 3 * W; i++)
        line[i] = 1 / (float)(i + 3);
    make_rows(&r, ROWS_RGBE);
    ck_assert_int_eq(rows_write_line(&r, H - 1, line, NULL), 0);
    ck_assert_int_eq(put_coded(&r, 0, 0, W, H), 0);
    ck_assert_int_eq(rows_sync(&opened, NULL), 0);
    ck_assert_int_eq(rows_open(&again, &opened, r.path,
                               (struct rows_form){ W, H, ROWS_RGBE, true },
                               NULL),
                     0);
    ck_assert_int_eq(rows_read_line(&again, H - 1, back, NULL), 0);
    ck_assert_mem_eq(line, back, sizeof line);
    ck_assert_int_eq(rows_read_line(&again, H - 2, back, NULL), 0);
    ck_assert_float_eq(back[0], 0); /* has not come */
    ck_assert_int_eq(rows_write_line(&again, H, line, NULL), RAD_EDATA);
    ck_assert_int_eq(rows_read_line(&again, -1, back, NULL), RAD_EDATA);
    rows_release(&again);
    rows_remove(&r);
    make_rows(&r, ROWS_COLOURS);
    ck_assert_int_eq(rows_write_line(&r, 0, line, NULL), RAD_EDATA);
    rows_remove(&r);
}

/* The preview of a frame that holds one bright sample, at x, y, and no other.
 */
static struct rad_picture
preview_of(int width, int height, int oversample, int x, int y)
{
    struct rad_filter_shape shape = { width, height, oversample, 0, false };
    struct rad_hdr_info info = { .program = "check_rows",
                                 .options = "-ab 0",
                                 .pixaspect = 1,
                                 .width = rad_filter_side(width, oversample),
                                 .height =
                                     rad_filter_side(height, oversample) };
    struct rows_open open = { 0 };
    struct rad_picture pic;
    unsigned char *bytes;
    uint8_t bright[4];
    struct rows r;
    char path[160];
    struct rows_output out = { .path = path, .preview = true, .edges = true };
    size_t n;

    rad_rgbe(rad_grey(3), bright);
    snprintf(path, sizeof path, "%s/rows", dir);
    create(&r, &open, path,
           (struct rows_form){ width, height, ROWS_RGBE, false });
    ck_assert_int_eq(
        rows_write(&r, (struct rows_area){ x, y, 1, 1 }, bright, NULL), 0);
    snprintf(path, sizeof path, "%s/preview", dir);
    ck_assert_int_eq(filtered_picture(&r, &shape, &info, &out, NULL), 0);
    rows_remove(&r);
    bytes = rad_file_read(path, 1 << 24, &n, NULL);
    ck_assert_ptr_nonnull(bytes);
    ck_assert_int_eq(rad_hdr_read(bytes, n, 1 << 22, &pic, NULL), 0);
    free(bytes);
    ck_assert_int_eq(pic.width, info.width);
    ck_assert_int_eq(pic.height, info.height);
    return pic;
}

/* Of few samples a preview is filtered as the picture will be: the bright one
 * spreads.  Of very many it costs no more than its own pixels. */
TEST(previews_of_many_samples_are_of_those_in_the_middle)
{
    int w = 8 * 1024, h = 8 * 513;
    struct rad_picture pic = preview_of(80, 40, 8, 36, 20);

    ck_assert_float_gt(pic.L[2 * 10 + 4].r, 0);
    ck_assert_float_lt(pic.L[2 * 10 + 4].r, 1);
    ck_assert_float_gt(pic.L[2 * 10 + 3].r, 0);
    ck_assert_int_gt(rad_edges_count(&pic.edges, 2), 0);
    rad_picture_release(&pic);
    pic = preview_of(w, h, 8, 8 * 700 + 4, 8 * 300 + 4);
    for (int i = 0; i < pic.width * pic.height; i++) {
        bool middle = i == 300 * pic.width + 700;

        ck_assert(middle ? fabsf(pic.L[i].r - 3) < .05f : pic.L[i].r == 0);
    }
    for (int y = 0; y < pic.height; y++)
        ck_assert_int_eq(rad_edges_count(&pic.edges, y), 0);
    rad_picture_release(&pic);
}

static const struct {
    enum rows_kind kind;
    int oversample;
    bool none; /* no rows have come */
} shown[] = {
    { ROWS_CODED, 1, false },     { ROWS_CODED, 1, true },
    { ROWS_RGBE, 1, false },      { ROWS_RGBE, 2, false },
    { ROWS_DISTANCES, 1, false },
};

/* Rows 8 to 11 of a frame have come, and are black. */
static void
put_some(struct rows *r)
{
    static struct rad_rgb black[24];
    uint8_t code[RAD_HDR_ROW_BYTES(24)];
    float floats[4 * 24] = { 0 };
    size_t n = rad_hdr_encode_row(black, r->width, code);
    int rc = 0;

    for (int y = 8; y < 12 && rc == 0; y++)
        rc = r->kind == ROWS_DISTANCES
                 ? rows_write(r, (struct rows_area){ 0, y, r->width, 1 },
                              floats, NULL)
                 : write_code(r, 0, y, r->width, 1, code, n, NULL);
    ck_assert_int_eq(rc, 0);
}

LOOP_TEST(previews_show_colours_where_rows_are_missing, N_ELEM(shown))
{
    int n = shown[_i].oversample, w = 24, h = 20;
    struct rad_filter_shape shape = { w, h, n, 0, false };
    struct rad_hdr_info info = { .program = "check_rows",
                                 .options = "-ab 0",
                                 .pixaspect = 1,
                                 .width = w / n,
                                 .height = h / n };
    uint8_t rgbe[4 * 3 * 3];
    struct action_colours k = { 0, 0, 0, 8, 3, 3, rgbe };
    struct rows_open open = { 0 };
    struct rad_picture pic;
    unsigned char *bytes;
    struct rows r;
    char path[160];
    struct rows_output out = { .path = path, .preview = true };
    size_t len;

    for (size_t i = 0; i < 9; i++)
        rad_rgbe(rad_grey(3), rgbe + 4 * i);
    snprintf(path, sizeof path, "%s/rows", dir);
    create(&r, &open, path, (struct rows_form){ w, h, shown[_i].kind, false });
    rows_put_colours(&r, &k);
    if (!shown[_i].none)
        put_some(&r);
    snprintf(path, sizeof path, "%s/preview", dir);
    ck_assert_int_eq(n > 1 ? filtered_picture(&r, &shape, &info, &out, NULL)
                           : rows_picture(&r, &info, &out, NULL),
                     0);
    rows_remove(&r);
    bytes = rad_file_read(path, 1 << 24, &len, NULL);
    ck_assert_int_eq(rad_hdr_read(bytes, len, 1 << 22, &pic, NULL), 0);
    free(bytes);
    for (int i = 0; i < pic.width * pic.height; i++) {
        int y = i / pic.width * n;
        bool edge = n > 1 && y >= 6 && y <= 12; /* it is filtered */
        bool came = !shown[_i].none && y >= 8 && y < 12;

        ck_assert(pic.L[i].g < 2 || !came);
        ck_assert(edge || fabsf(pic.L[i].g - (came ? 0 : 3)) < .1f);
    }
    rad_picture_release(&pic);
}
