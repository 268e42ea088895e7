/* check_store.c - files by hash, rows and pictures on disk */
#include "config.h"

#include "base/output.h"
#include "ground/sanitized.h"
#include "files/blobs.h"
#include "ground/disk.h"
#include "folder/filtered.h"
#include "journal/journal.h"
#include "image/hdr.h"
#include "folder/rows.h"
#include "ground/service.h"
#include "files/sound.h"
#include "store/store.h"

#include "unit.h"

#include <dirent.h>
#include <fcntl.h>
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static char dir[64];

static int
remove_entry(const char *path, const struct stat *st, int flag, struct FTW *f)
{
    (void)st;
    (void)flag;
    (void)f;
    return remove(path);
}

static void
setup(void)
{
    snprintf(dir, sizeof dir, "/tmp/check_store.XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(dir));
}

static void
teardown(void)
{
    nftw(dir, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

static void
hash_of(const void *data, size_t n, char hex[RAD_SHA_HEX + 1])
{
    ck_assert_int_eq(rad_sha_hex(data, n, hex, NULL), 0);
}

/* --- blobs --- */

/* Is it there?  *size (may be NULL) gets its length. */
static bool
has_blob(const struct blobs *b, const char *hash, uint64_t *size)
{
    char path[BLOBS_PATH_MAX];
    struct stat st;

    blobs_path(b, hash, path);
    if (stat(path, &st) < 0)
        return false;
    if (size)
        *size = (uint64_t)st.st_size;
    return true;
}

static int
read_blob(const struct blobs *b, const char *hash, off_t at, void *buf,
          size_t n)
{
    char path[BLOBS_PATH_MAX];
    int fd, rc;

    blobs_path(b, hash, path);
    fd = open(path, O_RDONLY);
    ck_assert_int_ge(fd, 0);
    rc = disk_read_at(fd, buf, n, at, path, NULL);
    close(fd);
    return rc;
}

START_TEST(file_that_came_in_pieces_is_there)
{
    static const char text[] = "void plastic white 0 0 5 1 1 1 0 0";
    size_t n = sizeof text;
    char hex[RAD_SHA_HEX + 1], back[sizeof text];
    struct blob_part p;
    struct blobs b;
    uint64_t size;

    hash_of(text, n, hex);
    ck_assert_int_eq(blobs_open(&b, dir, true, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, hex, n, NULL), 0);
    ck_assert_int_eq(blobs_part_write(&p, 0, text, 10, NULL), 0);
    ck_assert(!has_blob(&b, hex, NULL));
    ck_assert_int_eq(blobs_part_write(&p, 10, text + 10, n - 10, NULL), 1);
    ck_assert(has_blob(&b, hex, &size));
    ck_assert_uint_eq(size, n);
    ck_assert_int_eq(read_blob(&b, hex, 5, back, n - 5), 0);
    ck_assert_mem_eq(back, text + 5, n - 5);
    ck_assert_int_eq(read_blob(&b, hex, 6, back, n - 5), RAD_EIO);
}
END_TEST

START_TEST(empty_file_is_a_file)
{
    char hex[RAD_SHA_HEX + 1];
    struct blob_part p;
    struct blobs b;

    hash_of("", 0, hex);
    ck_assert_int_eq(blobs_open(&b, dir, false, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, hex, 0, NULL), 0);
    ck_assert_int_eq(blobs_part_write(&p, 0, NULL, 0, NULL), 1);
    ck_assert(has_blob(&b, hex, NULL));
}
END_TEST

static const struct {
    uint64_t total, offset;
    size_t n;
    bool other; /* another file's hash */
} wrong[] = {
    { 8, 1, 4, false }, /* does not begin at 0 */
    { 8, 0, 9, false }, /* more than was said */
    { 8, UINT64_MAX, 1, false },
    { 8, 0, 8, true }, /* not what its name says */
};

START_TEST(wrong_pieces_leave_nothing)
{
    static const char text[] = "12345678x";
    struct blob_part p;
    struct blobs b;
    char hex[RAD_SHA_HEX + 1], path[160];
    struct rad_error err = { 0 };

    hash_of(wrong[_i].other ? "other" : text, wrong[_i].other ? 5 : 8, hex);
    ck_assert_int_eq(blobs_open(&b, dir, false, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, hex, wrong[_i].total, NULL), 0);
    ck_assert_int_eq(
        blobs_part_write(&p, wrong[_i].offset, text, wrong[_i].n, &err),
        RAD_EPROTO);
    ck_assert_str_ne(err.what, "");
    ck_assert(!has_blob(&b, hex, NULL));
    snprintf(path, sizeof path, "%s/0.part", dir);
    ck_assert_int_ne(access(path, F_OK), 0);
}
END_TEST

START_TEST(bad_names_are_refused)
{
    struct blob_part p;
    struct blobs b;

    ck_assert_int_eq(blobs_open(&b, dir, false, NULL), 0);
    ck_assert_int_eq(blobs_part_open(&p, &b, "../../etc/passwd", 1, NULL),
                     RAD_EPROTO);
    ck_assert(!rad_sha_valid(".."));
}
END_TEST

START_TEST(half_files_of_an_earlier_life_go)
{
    struct blobs b;
    char path[160];
    FILE *f;

    snprintf(path, sizeof path, "%s/17.part", dir);
    f = fopen(path, "w");
    ck_assert_ptr_nonnull(f);
    fclose(f);
    ck_assert_int_eq(blobs_open(&b, dir, false, NULL), 0);
    ck_assert_int_ne(access(path, F_OK), 0);
}
END_TEST

/* --- rows --- */

enum { W = 10, H = 6 };

static float
value(int x, int y, int c)
{
    return (float)(1 + x + 100 * y) + 0.25f * (float)c;
}

static void
put(struct rows *r, int x, int y, int w, int h)
{
    float px[W * H * 4];

    for (int j = 0; j < h; j++)
        for (int i = 0; i < w; i++)
            for (int c = 0; c < (int)r->kind; c++)
                px[(j * w + i) * (int)r->kind + c] = value(x + i, y + j, c);
    ck_assert_int_eq(rows_write(r, x, y, w, h, px, NULL), 0);
}

static struct rows_open opened;

/* Use others until none of before is open. */
static void
push_out(void)
{
    struct rows other[ROWS_OPEN];
    char path[160];

    for (int i = 0; i < ROWS_OPEN; i++) {
        snprintf(path, sizeof path, "%s/other.%d", dir, i);
        ck_assert_int_eq(rows_create(&other[i], &opened, path, W, H,
                                     ROWS_COLOURS, false, NULL),
                         0);
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
    ck_assert_int_eq(rows_create(r, &opened, path, W, H, kind, true, NULL), 0);
}

START_TEST(windows_make_a_whole)
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
END_TEST

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

START_TEST(few_of_many_files_are_open)
{
    enum { MANY = 100 };
    static struct rows r[MANY];
    int before = open_files();
    float line[W * 4];
    char path[160];

    for (int i = 0; i < MANY; i++) {
        snprintf(path, sizeof path, "%s/%d.rows", dir, i);
        ck_assert_int_eq(
            rows_create(&r[i], &opened, path, W, H, ROWS_COLOURS, true, NULL),
            0);
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
END_TEST

static const int outside[][4] = {
    { -1, 0, 1, 1 },    { 0, -1, 1, 1 },         { 0, 0, W + 1, 1 },
    { 0, 0, 1, H + 1 }, { W, 0, 1, 1 },          { 0, H, 1, 1 },
    { 0, 0, 0, 1 },     { 3, 3, 2000000000, 1 },
};

START_TEST(pixels_outside_are_refused)
{
    const int *o = outside[_i];
    struct rows r;
    float px[W * H * 4] = { 0 };

    make_rows(&r, ROWS_COLOURS);
    ck_assert_int_eq(rows_write(&r, o[0], o[1], o[2], o[3], px, NULL),
                     RAD_EPROTO);
    rows_remove(&r);
}
END_TEST

static unsigned char *
slurp(const char *path, size_t *n)
{
    struct rad_error err = { 0 };
    unsigned char *p = rad_file_read(path, 1 << 20, n, &err);

    ck_assert_msg(p != NULL, "%s", err.what);
    return p;
}

START_TEST(picture_and_depth_hold_the_rows)
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
    unsigned char *data;
    float z;
    size_t n;

    make_rows(&r, ROWS_DISTANCES);
    put(&r, 0, 0, W, H);
    snprintf(path, sizeof path, "%s/f.hdr", dir);
    ck_assert_int_eq(rows_picture(&r, &info, path, true, NULL, NULL), 0);
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
    ck_assert_int_eq(rows_depth(&r, false, path, true, NULL, NULL), 0);
    data = slurp(path, &n);
    ck_assert_uint_eq(n, W * H * sizeof(float));
    memcpy(&z, data + (3 * W + 2) * sizeof z, sizeof z);
    ck_assert_float_eq(z, value(2, 3, 3));
    free(data);
    rows_remove(&r);
}
END_TEST

/* Rows of w pixels as they travel; returns the bytes. */
static size_t
code_rows(int x, int y, int w, int h, uint8_t *code)
{
    struct rad_rgb line[W];
    size_t n = 0;

    for (int j = y; j < y + h; j++) {
        for (int i = 0; i < w; i++)
            line[i] = rad_rgb(value(x + i, j, 0), value(x + i, j, 1),
                              value(x + i, j, 2));
        n += rad_hdr_encode_row(line, w, code + n);
    }
    return n;
}

static int
put_coded(struct rows *r, int x, int y, int w, int h)
{
    uint8_t code[H * RAD_HDR_ROW_BYTES(W)];
    size_t n = code_rows(x, y, w, h, code);

    return rows_write_coded(r, x, y, w, h, code, n, NULL, NULL);
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
START_TEST(coded_rows_make_the_picture_of_the_others)
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
    struct rows r;
    size_t n[2];

    for (int coded = 0; coded < 2; coded++) {
        snprintf(path, sizeof path, "%s/f.rows", dir);
        ck_assert_int_eq(rows_create(&r, &opened, path, W, H,
                                     coded ? kind : ROWS_COLOURS,
                                     codings[_i].durable, NULL),
                         0);
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
        ck_assert_int_eq(rows_picture(&r, &info, path, false, NULL, NULL), 0);
        data[coded] = slurp(path, &n[coded]);
        rows_remove(&r);
    }
    ck_assert_uint_eq(n[0], n[1]);
    ck_assert_mem_eq(data[0], data[1], n[0]);
    free(data[0]);
    free(data[1]);
}
END_TEST

START_TEST(coded_rows_that_are_none_are_refused)
{
    uint8_t code[2 * RAD_HDR_ROW_BYTES(W)];
    size_t n = code_rows(0, 0, W, 1, code);
    char path[160];
    struct rows r;

    snprintf(path, sizeof path, "%s/f.rows", dir);
    ck_assert_int_eq(
        rows_create(&r, &opened, path, W, H, ROWS_CODED, true, NULL),
        RAD_EINTERNAL);
    ck_assert_int_eq(
        rows_create(&r, &opened, path, W, H, (enum rows_kind)_i, false, NULL),
        0);
    ck_assert_int_eq(rows_write_coded(&r, 0, H, W, 1, code, n, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 0, -1, W, 1, code, n, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 1, 0, W, 1, code, n, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 0, 0, W, 2, code, n, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 0, 0, W, 1, code, n + 1, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 0, 0, W, 1, code, n - 1, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 0, 0, W - 1, 1, code, n, NULL, NULL),
                     RAD_EPROTO);
    ck_assert_int_eq(rows_write_coded(&r, 0, 0, W, 1, code, n, NULL, NULL), 0);
    rows_remove(&r);
}
END_TEST

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
START_TEST(coded_rows_are_taken_apart_a_few_at_a_time)
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
    ck_assert_int_eq(
        rows_create(&r, &opened, path, WIDE, MANY, ROWS_RGBE, false, NULL), 0);
    if (!RAD_SANITIZED) /* a sanitizer's shadow is memory, too */
        limit_memory(8 << 20);
    ck_assert_int_eq(
        rows_write_coded(&r, 0, 0, WIDE, MANY, code, n, &sum, NULL), 0);
    limit_memory(0);
    for (int y = 0; y < MANY; y++) {
        ck_assert_int_eq(rows_write_coded(&r, 0, y, WIDE, 1, code + at[y],
                                          at[y + 1] - at[y], &part, NULL),
                         0);
        pieces ^= part;
    }
    ck_assert_uint_ne(sum, 0);
    ck_assert_uint_eq(sum, pieces);
    rows_remove(&r);
    free(code);
    free(line);
}
END_TEST

/* To the bit, in another life too, and beside the coded rows. */
START_TEST(a_line_keeps_its_floats)
{
    float line[3 * W], back[3 * W];
    struct rows r, again;

    for (int i = 0; i < 3 * W; i++)
        line[i] = 1 / (float)(i + 3);
    make_rows(&r, ROWS_RGBE);
    ck_assert_int_eq(rows_write_line(&r, H - 1, line, NULL), 0);
    ck_assert_int_eq(put_coded(&r, 0, 0, W, H), 0);
    ck_assert_int_eq(rows_sync(&opened, NULL), 0);
    ck_assert_int_eq(rows_open(&again, &opened, r.path, W, H, ROWS_RGBE, NULL),
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
END_TEST

/* --- the store --- */

struct heard {
    int files, jobs, rows, pictures, status;
    uint64_t sequence;
    int chunks; /* written, of files not yet whole */
    uint32_t unit;
    ssize_t n;
    int read_status;
    uint64_t size, cache_size;
    int broken, filed;
    uint32_t settled, looked;
    bool full;
};

static void
on_file(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH], int status,
        const char *text)
{
    struct heard *h = arg;

    (void)hash;
    (void)text;
    ck_assert_uint_eq(conn, 5);
    h->files++;
    h->status = status;
}

static void
on_job(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence, int status,
       const char *text)
{
    struct heard *h = arg;

    (void)job;
    h->sequence = sequence;
    ck_assert_msg(status == 0, "%s", text);
    h->jobs++;
}

static void
on_rows(void *arg, const struct action_rows *key, int status, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->rows++;
    h->unit = key->unit;
    h->status = status;
}

static void
on_picture(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
           uint32_t frame, int status, const char *text)
{
    struct heard *h = arg;

    (void)job;
    ck_assert_uint_eq(sequence, 5);
    (void)frame;
    ck_assert_msg(status == 0, "%s", text);
    h->pictures++;
}

static void
on_read(void *arg, ssize_t n, uint64_t size, int status, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->n = n;
    h->size = size;
    h->read_status = status;
}

/* From its beginning, in one piece. */
static void
read_all(struct store *s, const struct store_source *from, void *buf, size_t n,
         struct heard *h)
{
    static struct store_reading r;

    store_reading_release(&r);
    r = (struct store_reading){ .from = *from };
    store_read(s, &r, buf, n, on_read, h);
}

static void
on_progress(void *arg)
{
    struct heard *h = arg;

    h->chunks++;
}

static void
on_broken(void *arg, int status, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->broken = status;
}

static void
on_filed(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
         uint64_t bytes, uint64_t cache_bytes)
{
    struct heard *h = arg;

    (void)job;
    h->sequence = sequence;
    h->filed++;
    h->size = bytes;
    h->cache_size = cache_bytes;
}

static void
on_settled(void *arg, uint64_t conn, uint32_t request)
{
    struct heard *h = arg;

    ck_assert_uint_eq(conn, 5);
    h->settled = request;
}

static void
on_fullness(void *arg, bool full, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->full = full;
}

static void
on_looked(void *arg, const struct action_look *l)
{
    struct heard *h = arg;

    h->looked = l->request;
    ck_assert_uint_eq(l->files.n, 1);
}

static const struct store_handler handler = { .looked = on_looked,
                                              .file = on_file,
                                              .job = on_job,
                                              .rows = on_rows,
                                              .picture = on_picture,
                                              .progress = on_progress,
                                              .broken = on_broken,
                                              .filed = on_filed,
                                              .settled = on_settled,
                                              .fullness = on_fullness };

static void
run(uv_loop_t *loop, struct store *s)
{
    while (!store_idle(s))
        uv_run(loop, UV_RUN_ONCE);
}

static void
put_file(struct store *s, const char *text, const char *name)
{
    uint8_t digest[MSG_HASH];
    char hex[RAD_SHA_HEX + 1];
    struct msg_chunk c = { .hash = digest,
                           .offset = 0,
                           .total = strlen(text),
                           .data = (const uint8_t *)text,
                           .len = strlen(text) };

    hash_of(name, strlen(name), hex);
    rad_sha_from_hex(hex, digest);
    store_put_chunk(s, 5, &c);
}

START_TEST(store_keeps_files_and_refuses_impostors)
{
    struct heard h = { 0 };
    uv_loop_t loop;
    struct store *s;

    uv_loop_init(&loop);
    s = store_open(&loop, dir, true, &handler, &h, NULL);
    ck_assert_ptr_nonnull(s);
    put_file(s, "hello", "hello");
    run(&loop, s);
    ck_assert_int_eq(h.files, 1);
    ck_assert_int_eq(h.status, 0);
    put_file(s, "olleh", "other");
    run(&loop, s);
    ck_assert_int_eq(h.files, 2);
    ck_assert_int_eq(h.status, 76);
    store_close(s);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}
END_TEST

START_TEST(store_tells_of_every_chunk)
{
    static const char text[] = "in three parts";
    struct heard h = { 0 };
    uint8_t digest[MSG_HASH];
    char hex[RAD_SHA_HEX + 1];
    uv_loop_t loop;
    struct store *s;

    hash_of(text, strlen(text), hex);
    rad_sha_from_hex(hex, digest);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, false, &handler, &h, NULL);
    ck_assert_ptr_nonnull(s);
    for (size_t at = 0, n; at < strlen(text); at += n) {
        struct msg_chunk c = { .hash = digest, .offset = at };

        n = strlen(text) - at < 5 ? strlen(text) - at : 5;
        c.total = strlen(text);
        c.data = (const uint8_t *)text + at;
        c.len = n;
        store_put_chunk(s, 5, &c);
        ck_assert_uint_ge(store_backlog(s), n);
        run(&loop, s);
        ck_assert_uint_eq(store_backlog(s), 0);
        ck_assert_int_eq(h.chunks + h.files, (int)(at / 5) + 1);
    }
    ck_assert_int_eq(h.chunks, 2);
    ck_assert_int_eq(h.files, 1);
    ck_assert_int_eq(h.status, 0);
    store_close(s);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}
END_TEST

/* Same length, another content. */
static void
damage(const char *file)
{
    char path[PATH_MAX];
    FILE *f;

    snprintf(path, sizeof path, "%s/files/%s", dir, file);
    f = fopen(path, "r+");
    ck_assert_ptr_nonnull(f);
    fputs("HELLO", f);
    fclose(f);
}

START_TEST(store_notices_damaged_files)
{
    struct heard h = { 0 };
    uint8_t digest[MSG_HASH];
    char hex[RAD_SHA_HEX + 1];
    uv_loop_t loop;
    struct store *s;

    hash_of("hello", 5, hex);
    rad_sha_from_hex(hex, digest);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, false, &handler, &h, NULL);
    ck_assert_ptr_nonnull(s);
    for (int again = 0; again < 2; again++) {
        put_file(s, "hello", "hello");
        run(&loop, s);
        ck_assert(store_check_file(s, digest));
        ck_assert(store_check_file(s, digest)); /* now known */
        damage(hex);
        ck_assert(!store_check_file(s, digest));
        ck_assert(!store_check_file(s, digest));
    }
    store_close(s);
    uv_loop_close(&loop);
}
END_TEST

/* Another process finds a file: it is read off the loop, once. */
START_TEST(files_are_read_behind_the_loop)
{
    struct heard h = { 0 };
    uint8_t digest[MSG_HASH];
    struct action_look look = { .request = 7,
                                .nlook = 1,
                                .files = { 1, digest } };
    char hex[RAD_SHA_HEX + 1];
    uv_loop_t loop;
    struct store *s;

    hash_of("hello", 5, hex);
    rad_sha_from_hex(hex, digest);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, false, &handler, &h, NULL);
    ck_assert(store_look(s, &look)); /* it is missing */
    put_file(s, "hello", "hello");
    run(&loop, s);
    ck_assert(store_look(s, &look)); /* it was written just now */
    store_close(s);
    if (_i)
        damage(hex);
    s = store_open(&loop, dir, false, &handler, &h, NULL);
    ck_assert(!store_look(s, &look));
    ck_assert_uint_eq(h.looked, 0);
    run(&loop, s);
    ck_assert_uint_eq(h.looked, 7);
    ck_assert(store_look(s, &look));
    ck_assert(store_check_file(s, digest) == !_i);
    store_close(s);
    uv_loop_close(&loop);
}
END_TEST

START_TEST(folder_serves_one_store)
{
    struct rad_error err = { 0 };
    struct heard h = { 0 };
    uv_loop_t loop;
    struct store *s;

    uv_loop_init(&loop);
    s = store_open(&loop, dir, true, &handler, &h, NULL);
    ck_assert_ptr_nonnull(s);
    ck_assert_ptr_null(store_open(&loop, dir, true, &handler, &h, &err));
    ck_assert_int_eq(err.code, RAD_ECANTCREAT);
    store_close(s);
    uv_loop_close(&loop);
}
END_TEST

/* File `name` of a folder below dir, made with it. */
static void
put_in(const char *folder, const char *name)
{
    char path[200];
    FILE *f;

    snprintf(path, sizeof path, "%s/%s", dir, folder);
    ck_assert_int_eq(rad_make_dir(path, 0700, NULL), 0);
    snprintf(path, sizeof path, "%s/%s/%s", dir, folder, name);
    f = fopen(path, "w");
    ck_assert_ptr_nonnull(f);
    fclose(f);
}

static bool
is_there(const char *name)
{
    char path[200];

    snprintf(path, sizeof path, "%s/%s", dir, name);
    return access(path, F_OK) == 0;
}

#define OLD_JOB "jobs/00112233445566778899aabbccddeeff"
#define OLD_HASH                                                               \
    "2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b"

START_TEST(without_a_database_jobs_go_and_files_stay)
{
    struct heard h = { 0 };
    uv_loop_t loop;
    struct store *s;

    put_in(OLD_JOB, "0.rows");
    put_in(OLD_JOB, "0.hdr");
    put_in("jobs/of-another-program", "0.rows");
    put_in("files", OLD_HASH);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, false, &handler, &h, NULL);
    ck_assert_ptr_nonnull(s);
    ck_assert(!is_there(OLD_JOB));
    ck_assert(is_there("jobs/of-another-program/0.rows"));
    ck_assert(is_there("files/" OLD_HASH));
    store_close(s);
    uv_loop_close(&loop);
}
END_TEST

static void
put_unit(struct store *s, const uint8_t *job, uint32_t unit, uint32_t rows,
         uint8_t channels)
{
    static uint8_t bytes[W * H * 16];
    float px[W * H * 4];
    struct action_rows a = { .unit = unit,
                             .rows = rows,
                             .y = unit * rows,
                             .width = W,
                             .channels = channels,
                             .pixels = bytes };

    for (size_t i = 0; i < (size_t)W * rows * channels; i++)
        px[i] = 2;
    wire_floats_put(bytes, px, (size_t)W * rows * channels);
    memcpy(a.job, job, MSG_JOB);
    store_keep_unit(s, job,
                    &(struct saved_unit){ .unit = unit,
                                          .area = { 0, 0, a.y, W, rows },
                                          .worker = "ws1" });
    store_put_rows(s, &a);
}

START_TEST(job_becomes_a_picture)
{
    static const uint8_t job[MSG_JOB] = { 1, 2, 3 };
    struct msg_frame frame = { 0, W, H, "-vtv -vp 0 0 0" };
    struct saved_job p = { .spec = { .name = "x",
                                     .params = "-ab 0",
                                     .frames = &frame,
                                     .nframes = 1 } };
    struct store_source from = { .what = MSG_WHAT_PREVIEW };
    struct heard h = { 0 };
    struct rad_picture pic;
    char buf[4096];
    uv_loop_t loop;
    struct store *s;

    memcpy(from.job, job, MSG_JOB);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, _i, &handler, &h, NULL);
    store_open_job(s, job, &p);
    put_unit(s, job, 0, 3, 3);
    run(&loop, s);
    ck_assert_int_eq(h.jobs, 1);
    ck_assert_int_eq(h.rows, 1);
    read_all(s, &from, buf, sizeof buf, &h);
    run(&loop, s);
    ck_assert_int_gt(h.n, 0);
    ck_assert_int_eq(
        rad_hdr_read((uint8_t *)buf, (size_t)h.n, 1000, &pic, NULL), 0);
    ck_assert_float_gt(pic.L[0].r, 1.9f);
    ck_assert_float_eq(pic.L[3 * W].r, 0); /* has not come */
    rad_picture_release(&pic);

    put_unit(s, job, 1, 3, 4); /* a distance that the job has not */
    run(&loop, s);
    ck_assert_int_eq(h.status, 76);
    put_unit(s, job, 1, 3, 3);
    store_write_picture(s, job, 5, 0);
    from.what = MSG_WHAT_PICTURE;
    read_all(s, &from, buf, sizeof buf, &h);
    run(&loop, s);
    ck_assert_int_eq(h.status, 0);
    ck_assert_int_eq(h.pictures, 1);
    ck_assert_uint_eq((uint64_t)h.n, h.size);
    ck_assert_int_eq(
        rad_hdr_read((uint8_t *)buf, (size_t)h.n, 1000, &pic, NULL), 0);
    ck_assert_float_gt(pic.L[W * H - 1].r, 1.9f);
    rad_picture_release(&pic);

    store_forget_job(s, &(struct saved_gone){ .job = { 1, 2, 3 } });
    read_all(s, &from, buf, sizeof buf, &h);
    run(&loop, s);
    ck_assert_int_lt(h.n, 0);
    store_close(s);
    uv_loop_close(&loop);
}
END_TEST

/* --- files that go --- */

/* As if nobody had asked for it for so long. */
static void
make_old(const char *text, long s)
{
    struct timespec times[2] = { { .tv_sec = time(NULL) - s }, { 0 } };
    char hex[RAD_SHA_HEX + 1], path[300];

    times[1] = times[0];
    ck_assert_int_eq(rad_sha_hex(text, strlen(text), hex, NULL), 0);
    snprintf(path, sizeof path, "%s/files/%s", dir, hex);
    ck_assert_int_eq(utimensat(AT_FDCWD, path, times, 0), 0);
}

static bool
has_text(const char *text)
{
    char hex[RAD_SHA_HEX + 1], path[RAD_SHA_HEX + 8];

    ck_assert_int_eq(rad_sha_hex(text, strlen(text), hex, NULL), 0);
    snprintf(path, sizeof path, "files/%s", hex);
    return is_there(path);
}

static void
digest_of(const char *text, uint8_t digest[MSG_HASH])
{
    char hex[RAD_SHA_HEX + 1];

    ck_assert_int_eq(rad_sha_hex(text, strlen(text), hex, NULL), 0);
    rad_sha_from_hex(hex, digest);
}

START_TEST(files_that_no_job_needs_go_after_a_day)
{
    static const char *const texts[] = { "needed", "asked for", "new",
                                         "forgotten", "old" };
    uint8_t *keep = malloc(MSG_HASH), asked[MSG_HASH];
    struct heard h = { 0 };
    uv_loop_t loop;
    struct store *s;
    FILE *f;
    char path[200];

    uv_loop_init(&loop);
    s = store_open(&loop, dir, true, &handler, &h, NULL);
    ck_assert_ptr_nonnull(s);
    for (int i = 0; i < N_ELEM(texts); i++)
        put_file(s, texts[i], texts[i]);
    run(&loop, s);
    for (int i = 0; i < N_ELEM(texts); i++)
        if (strcmp(texts[i], "new") != 0)
            make_old(texts[i], 3600 + 60);
    snprintf(path, sizeof path, "%s/files/a note of somebody's", dir);
    f = fopen(path, "w");
    ck_assert_ptr_nonnull(f);
    fclose(f);
    digest_of("asked for", asked);
    ck_assert(store_check_file(s, asked));
    digest_of("needed", keep);
    store_sweep(s, keep, 1, 3600);
    run(&loop, s);
    ck_assert(has_text("needed") && has_text("asked for") && has_text("new"));
    ck_assert(!has_text("forgotten") && !has_text("old"));
    ck_assert(is_there("files/a note of somebody's"));
    store_close(s);
    uv_loop_close(&loop);
}
END_TEST

/* --- another life --- */

static const uint8_t kept_job[MSG_JOB] = { 9, 8, 7 };
static const uint8_t kept_manifest[MSG_HASH] = { 6, 5, 4 };
static const struct msg_frame kept_frame = { 0, W, H, "-vtv -vp 0 0 0" };

static void
open_kept(uv_loop_t *loop, struct store **s, struct heard *h)
{
    struct rad_error err = { 0 };

    memset(h, 0, sizeof *h);
    uv_loop_init(loop);
    *s = store_open(loop, dir, true, &handler, h, &err);
    ck_assert_msg(*s != NULL, "%s: %s", err.where, err.what);
}

static void
close_kept(uv_loop_t *loop, struct store *s)
{
    run(loop, s);
    store_close(s);
    ck_assert_int_eq(uv_loop_close(loop), 0);
}

static int
note_job(void *arg, const struct saved_job *s, struct rad_error *err)
{
    struct saved_job *to = arg;

    (void)err;
    ck_assert_mem_eq(s->spec.job, kept_job, MSG_JOB);
    ck_assert_str_eq(s->spec.params, "-ab 0");
    ck_assert_str_eq(s->owner, "ana");
    ck_assert_str_eq(s->spec.frames[0].view, kept_frame.view);
    *to = *s;
    if (s->nunits > 0) {
        ck_assert_uint_eq(s->units[0].area.height, 3);
        ck_assert_str_eq(s->units[0].worker, "ws1");
        ck_assert_uint_eq(s->units[0].stored, 3);
    }
    return 0;
}

static int
recover(struct store *s, struct saved_job *job, struct rad_error *err)
{
    uint64_t epoch;

    memset(job, 0, sizeof *job);
    return store_recover(s, 1000, &epoch, note_job, job, err);
}

static void
make_kept(uv_loop_t *loop, struct store **s, struct heard *h)
{
    struct saved_job p = { .spec = { .manifest = kept_manifest,
                                     .params = "-ab 0",
                                     .frames = &kept_frame,
                                     .nframes = 1 },
                           .owner = "ana" };
    struct saved_job none;

    open_kept(loop, s, h);
    ck_assert_int_eq(recover(*s, &none, NULL), 0);
    store_open_job(*s, kept_job, &p);
    put_unit(*s, kept_job, 0, 3, 3);
    run(loop, *s);
    ck_assert_int_eq(h->jobs, 1);
    ck_assert_int_eq(h->rows, 1);
    ck_assert_int_eq(h->status, 0);
}

START_TEST(a_job_goes_on_in_another_life)
{
    struct saved_job job;
    struct heard h;
    uint8_t row[W * 3 * 4];
    float px[3];
    uv_loop_t loop;
    struct store *s;

    make_kept(&loop, &s, &h);
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_uint_eq(job.nunits, 1);
    ck_assert_uint_eq(job.lives, 1);
    ck_assert(store_read_row(s, kept_job, 0, 2, row));
    wire_floats_get(px, row, 3);
    ck_assert_float_eq(px[0], 2);
    put_unit(s, kept_job, 1, 3, 3);
    store_write_picture(s, kept_job, 5, 0);
    store_settle(s, 5, 44);
    close_kept(&loop, s);
    ck_assert_int_eq(h.pictures, 1);
    ck_assert_uint_eq(h.settled, 44);
    ck_assert(is_there("jobs/09080700000000000000000000000000/0.hdr"));
    ck_assert(!is_there("jobs/09080700000000000000000000000000/0.rows"));
}
END_TEST

START_TEST(a_job_that_is_over_is_remembered_and_forgotten)
{
    struct store_source from = { .what = MSG_WHAT_STATS };
    struct saved_job job, end = { .spec = { .job = kept_job,
                                            .manifest = kept_manifest,
                                            .params = "-ab 0",
                                            .frames = &kept_frame,
                                            .nframes = 1 },
                                  .sequence = 6,
                                  .state = 4,
                                  .status = 70,
                                  .text = "it was too late",
                                  .last = { .state = 4, .rays = 17 } };
    struct heard h;
    char buf[100];
    uv_loop_t loop;
    struct store *s;

    memcpy(from.job, kept_job, MSG_JOB);
    make_kept(&loop, &s, &h);
    store_end_job(s, &end, strdup("{ }"), 3);
    close_kept(&loop, s);
    ck_assert_int_eq(h.filed, 1);
    ck_assert_uint_eq(h.sequence, 6);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_uint_eq(job.state, 4);
    ck_assert_int_eq(job.status, 70);
    ck_assert_uint_eq(job.last.rays, 17);
    read_all(s, &from, buf, sizeof buf, &h);
    run(&loop, s);
    ck_assert_int_eq(h.n, 3);
    store_forget_job(s, &(struct saved_gone){ .job = { 9, 8, 7 } });
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(recover(s, &job, NULL), 0);
    ck_assert_ptr_null(job.spec.job);
    close_kept(&loop, s);
}
END_TEST

/* What somebody may do to a state folder, and what is said of it. */
static const struct {
    const char *command, *what;
} damages[] = {
    { "rm jobs/*/0.rows", "missing" },
    { "truncate -s 100 jobs/*/0.rows", "100 bytes" },
    { "rm radcoord.db*", "no database" },
    { "echo no database, this >radcoord.db", "database" },
    { "truncate -s 3000 radcoord.db", "database" },
};

START_TEST(a_damaged_folder_is_refused)
{
    struct rad_error err = { 0 };
    struct saved_job job;
    struct heard h;
    char command[200];
    uv_loop_t loop;
    struct store *s;

    make_kept(&loop, &s, &h);
    close_kept(&loop, s);
    snprintf(command, sizeof command, "cd %s && %s", dir, damages[_i].command);
    ck_assert_int_eq(system(command), 0);
    uv_loop_init(&loop);
    s = store_open(&loop, dir, true, &handler, &h, &err);
    if (s) {
        ck_assert_int_lt(recover(s, &job, &err), 0);
        store_close(s);
    }
    uv_loop_close(&loop);
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.where, "is damaged"));
    ck_assert_msg(strstr(err.what, damages[_i].what) != NULL, "%s", err.what);
    ck_assert_ptr_nonnull(strstr(err.what, "radctl check"));
}
END_TEST

static uint8_t
line_byte(int i)
{
    return (uint8_t)(7 * i % 64);
}

/* Rows of unit 0 come in two pieces, those of unit 1 in one; each unit leaves
 * a base line, with so many densities. */
static void
put_pieces(struct store *s, bool coded, uint32_t densities)
{
    static const uint32_t first[] = { 0, 1, 3 }, n[] = { 1, 2, 3 };
    uint8_t bytes[W * H * 12], code[H * RAD_HDR_ROW_BYTES(W)];

    for (int i = 0; i < N_ELEM(bytes); i++)
        bytes[i] = line_byte(i);

    for (uint32_t unit = 0; unit < 2; unit++)
        store_keep_unit(s, kept_job,
                        &(struct saved_unit){ .unit = unit,
                                              .area = { 0, 0, 3 * unit, W, 3 },
                                              .worker = "ws1" });
    for (int i = 0; i < N_ELEM(first); i++) {
        struct action_rows a = { .unit = first[i] / 3,
                                 .row = first[i] % 3,
                                 .rows = n[i],
                                 .y = first[i],
                                 .width = W,
                                 .channels = coded ? 1 : 3,
                                 .pixels = bytes,
                                 .last = i > 0,
                                 .counts = &(struct msg_counts){ 0 } };

        if (coded) {
            a.pixels = code;
            a.len = code_rows(0, (int)first[i], W, (int)n[i], code);
        }
        if (a.last) {
            a.bottom = bytes;
            a.nbottom = densities;
            a.line = coded ? bytes : NULL;
        }
        memcpy(a.job, kept_job, MSG_JOB);
        store_put_rows(s, &a);
    }
}

static int
note_stored(void *arg, const struct saved_job *s, struct rad_error *err)
{
    uint32_t *stored = arg;

    (void)err;
    ck_assert_uint_eq(s->nunits, 2);
    for (uint32_t i = 0; i < 2; i++)
        stored[i] = s->units[i].stored;
    return 0;
}

/* What is spoilt: a byte in each row, at a row's column, of floats, of RGBE,
 * and of the lines that are kept behind that. */
static const struct {
    bool coded;
    uint32_t densities;
    long at;
    int unit; /* whose rows are none then; 2: both's, -1: nobody's */
} spoilt[] = {
    { false, 1, 0, 0 },
    { false, 1, W * 12 + 1, 0 },
    { false, 1, 2 * W * 12 + 2, 0 },
    { false, 1, 3 * W * 12 + 3, 1 },
    { false, 1, 5 * W * 12 + 5, 1 },
    { true, 1, 0, 0 },
    { true, 1, W * 4 + 1, 0 },
    { true, 1, 3 * W * 4 - 1, 0 },
    { true, 1, 3 * W * 4, 1 },
    { true, 1, 6 * W * 4 - 1, 1 },
    { true, 1, H *W * 4 + 2 * W * 12 - 1, -1 }, /* no line is there */
    { true, 1, H *W * 4 + 2 * W * 12, 0 },
    { true, 1, H *W * 4 + 6 * W * 12 - 1, 1 },
    { true, 1, -1, -1 },
    { true, 0, H *W * 4 + 2 * W * 12, 0 }, /* -ps 1 has none */
    { true, 0, 0, 0 },
    { true, 0, -1, -1 },
    /* nothing was kept of the base line above */
    { false, 0, 3 * W * 12 + 3, 2 },
    { false, 0, 0, 0 },
};

/* Also in lives to come. */
START_TEST(rows_that_a_disk_has_spoilt_are_none)
{
    bool coded = spoilt[_i].coded;
    int unit = spoilt[_i].unit;
    uint32_t stored[2];
    struct saved_job p = { .spec = { .manifest = kept_manifest,
                                     .params = "-ab 0",
                                     .flags = coded ? MSG_JOB_CODED : 0,
                                     .frames = &kept_frame,
                                     .nframes = 1 },
                           .owner = "ana" };
    struct heard h;
    uint64_t epoch;
    char path[200];
    uv_loop_t loop;
    struct store *s;
    FILE *f;

    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    store_open_job(s, kept_job, &p);
    put_pieces(s, coded, spoilt[_i].densities);
    close_kept(&loop, s);
    ck_assert_int_eq(h.rows, 3);
    if (spoilt[_i].at >= 0) {
        snprintf(path, sizeof path, "%s/jobs/%s/0.rows", dir,
                 "09080700000000000000000000000000");
        f = fopen(path, "r+");
        ck_assert_ptr_nonnull(f);
        ck_assert_int_eq(fseek(f, spoilt[_i].at, SEEK_SET), 0);
        ck_assert_int_eq(fputc(0x55, f), 0x55);
        ck_assert_int_eq(fclose(f), 0);
    }
    for (int life = 0; life < 2; life++) {
        open_kept(&loop, &s, &h);
        ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL),
                         0);
        close_kept(&loop, s);
        ck_assert_uint_eq(stored[0], unit == 0 || unit == 2 ? 0 : 3);
        ck_assert_uint_eq(stored[1], unit == 1 || unit == 2 ? 0 : 3);
    }
}
END_TEST

/* Its floats, of rows that are RGBE. */
START_TEST(a_units_base_line_outlives_the_store)
{
    struct saved_job p = { .spec = { .manifest = kept_manifest,
                                     .params = "-ab 0",
                                     .flags = MSG_JOB_CODED,
                                     .frames = &kept_frame,
                                     .nframes = 1 },
                           .owner = "ana" };
    uint8_t line[W * 12];
    uint32_t stored[2];
    struct heard h;
    uint64_t epoch;
    uv_loop_t loop;
    struct store *s;

    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    store_open_job(s, kept_job, &p);
    put_pieces(s, true, 1);
    close_kept(&loop, s);
    open_kept(&loop, &s, &h);
    ck_assert_int_eq(store_recover(s, 1, &epoch, note_stored, stored, NULL), 0);
    for (uint32_t y = 2; y < H; y += 3) {
        ck_assert(store_read_row(s, kept_job, 0, y, line));
        for (int i = 0; i < N_ELEM(line); i++)
            ck_assert_uint_eq(line[i], line_byte(i));
    }
    ck_assert(store_read_row(s, kept_job, 0, 1, line));
    ck_assert_uint_eq(line[1], 0); /* in the middle of a unit */
    close_kept(&loop, s);
}
END_TEST

/* --- service --- */

/* Of one bucket, which is where the bound is. */
START_TEST(sounds_of_very_many_files_are_forgotten)
{
    const uint32_t most = SOUND_MOST / SOUND_BUCKETS, n = 3 * most;
    uint8_t digest[RAD_SHA_BYTES] = { 7 };
    struct sounds s = { 0 };
    uint32_t known = 0;
    char path[100];

    snprintf(path, sizeof path, "%s/file", dir);
    fclose(fopen(path, "w"));
    for (uint32_t i = 0; i < n; i++) {
        memcpy(digest + 4, &i, sizeof i);
        sounds_note(&s, digest, path);
    }
    ck_assert(sounds_known(&s, digest, path));
    for (uint32_t i = 0; i < n; i++) {
        memcpy(digest + 4, &i, sizeof i);
        known += sounds_known(&s, digest, path);
    }
    ck_assert_uint_eq(known, most);
    sounds_release(&s);
}
END_TEST

/* What a loss of power leaves of one that was being made is in nobody's way, and
 * one that has its name is whole, whatever becomes of its log. */
START_TEST(a_database_gets_its_name_when_it_is_whole)
{
    char path[160], made[170], log[170];
    struct journal *j;
    FILE *f;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
    snprintf(made, sizeof made, "%s.new", path);
    snprintf(log, sizeof log, "%s-wal", path);
    f = fopen(made, "w");
    ck_assert_ptr_nonnull(f);
    fputs("half a database", f);
    fclose(f);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    journal_close(j);
    ck_assert_int_ne(access(made, F_OK), 0);
    f = fopen(log, "w");
    ck_assert_ptr_nonnull(f);
    fputs("half a log", f);
    fclose(f);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_OPEN, NULL), 0);
    journal_close(j);
}
END_TEST

/* The preview of a frame that holds one bright sample, at x, y, and no other. */
static struct rad_picture
preview_of(int width, int height, int oversample, int x, int y)
{
    struct rad_filter_shape shape = { width, height, oversample, 0, false };
    struct rad_hdr_info info = { .program = "check_store",
                                 .options = "-ab 0",
                                 .pixaspect = 1,
                                 .width = rad_filter_side(width, oversample),
                                 .height = rad_filter_side(height, oversample) };
    struct rows_open open = { 0 };
    struct rad_picture pic;
    unsigned char *bytes;
    uint8_t bright[4];
    struct rows r;
    char path[160];
    size_t n;

    rad_rgbe(rad_grey(3), bright);
    snprintf(path, sizeof path, "%s/rows", dir);
    ck_assert_int_eq(rows_create(&r, &open, path, width, height, ROWS_RGBE,
                                 false, NULL),
                     0);
    ck_assert_int_eq(rows_write(&r, x, y, 1, 1, bright, NULL), 0);
    snprintf(path, sizeof path, "%s/preview", dir);
    ck_assert_int_eq(filtered_preview(&r, &shape, &info, path, NULL), 0);
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
START_TEST(previews_of_many_samples_are_of_those_in_the_middle)
{
    int w = 8 * 1024, h = 8 * 513;
    struct rad_picture pic = preview_of(80, 40, 8, 36, 20);

    ck_assert_float_gt(pic.L[2 * 10 + 4].r, 0);
    ck_assert_float_lt(pic.L[2 * 10 + 4].r, 1);
    ck_assert_float_gt(pic.L[2 * 10 + 3].r, 0);
    rad_picture_release(&pic);
    pic = preview_of(w, h, 8, 8 * 700 + 4, 8 * 300 + 4);
    for (int i = 0; i < pic.width * pic.height; i++) {
        bool middle = i == 300 * pic.width + 700;

        ck_assert(middle ? fabsf(pic.L[i].r - 3) < .05f : pic.L[i].r == 0);
    }
    rad_picture_release(&pic);
}
END_TEST

static const struct {
    enum rows_kind kind;
    int oversample;
} shown[] = {
    { ROWS_CODED, 1 }, { ROWS_RGBE, 1 }, { ROWS_RGBE, 2 }, { ROWS_DISTANCES, 1 }
};

/* Rows 8 to 11 of a frame have come, and are black; passes told colours. */
static void
put_some(struct rows *r, const struct action_colours *colours)
{
    static struct rad_rgb black[24];
    uint8_t code[RAD_HDR_ROW_BYTES(24)];
    float floats[4 * 24] = { 0 };
    size_t n = rad_hdr_encode_row(black, r->width, code);
    int rc = 0;

    rows_put_colours(r, colours);
    for (int y = 8; y < 12 && rc == 0; y++)
        rc = r->kind == ROWS_DISTANCES
                 ? rows_write(r, 0, y, r->width, 1, floats, NULL)
                 : rows_write_coded(r, 0, y, r->width, 1, code, n, NULL, NULL);
    ck_assert_int_eq(rc, 0);
}

START_TEST(previews_show_colours_where_rows_are_missing)
{
    int n = shown[_i].oversample, w = 24, h = 20;
    struct rad_filter_shape shape = { w, h, n, 0, false };
    struct rad_hdr_info info = { .program = "check_store",
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
    size_t len;

    for (size_t i = 0; i < 9; i++)
        rad_rgbe(rad_grey(3), rgbe + 4 * i);
    snprintf(path, sizeof path, "%s/rows", dir);
    ck_assert_int_eq(
        rows_create(&r, &open, path, w, h, shown[_i].kind, false, NULL), 0);
    put_some(&r, &k);
    snprintf(path, sizeof path, "%s/preview", dir);
    ck_assert_int_eq(n > 1 ? filtered_preview(&r, &shape, &info, path, NULL)
                           : rows_picture(&r, &info, path, false, NULL, NULL),
                     0);
    rows_remove(&r);
    bytes = rad_file_read(path, 1 << 24, &len, NULL);
    ck_assert_int_eq(rad_hdr_read(bytes, len, 1 << 22, &pic, NULL), 0);
    free(bytes);
    for (int i = 0; i < pic.width * pic.height; i++) {
        int y = i / pic.width * n;
        bool edge = n > 1 && y >= 6 && y <= 12; /* it is filtered */

        ck_assert(pic.L[i].g < 2 || y < 8 || y >= 12);
        ck_assert(edge || fabsf(pic.L[i].g - (y >= 8 && y < 12 ? 0 : 3)) < .1f);
    }
    rad_picture_release(&pic);
}
END_TEST

START_TEST(folders_are_made_and_files_written_whole)
{
    char deep[160], ports[200], text[100];
    const char *lines[] = { "unix /x", "tcp 127.0.0.1:1" };
    struct rad_error err = { 0 };
    FILE *f;

    snprintf(deep, sizeof deep, "%s/a/b/c", dir);
    ck_assert_int_eq(rad_make_dir(deep, 0700, NULL), 0);
    ck_assert_int_eq(rad_make_dir(deep, 0700, NULL), 0);
    snprintf(ports, sizeof ports, "%s/ports", deep);
    ck_assert_int_eq(service_ports_file(ports, lines, 2, NULL), 0);
    f = fopen(ports, "r");
    ck_assert_ptr_nonnull(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    ck_assert_str_eq(text, "unix /x\ntcp 127.0.0.1:1\n");
    snprintf(deep, sizeof deep, "%s/ports/x", dir);
    snprintf(ports, sizeof ports, "%s/ports", dir);
    ck_assert_int_eq(service_ports_file(ports, lines, 1, NULL), 0);
    ck_assert_int_eq(rad_make_dir(deep, 0700, &err), RAD_ECANTCREAT);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("store");
    TCase *tc = tcase_create("store");

    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_test(tc, file_that_came_in_pieces_is_there);
    tcase_add_test(tc, empty_file_is_a_file);
    tcase_add_loop_test(tc, wrong_pieces_leave_nothing, 0, N_ELEM(wrong));
    tcase_add_test(tc, bad_names_are_refused);
    tcase_add_test(tc, half_files_of_an_earlier_life_go);
    tcase_add_loop_test(tc, windows_make_a_whole, 3, 5);
    tcase_add_test(tc, few_of_many_files_are_open);
    tcase_add_loop_test(tc, pixels_outside_are_refused, 0, N_ELEM(outside));
    tcase_add_test(tc, picture_and_depth_hold_the_rows);
    tcase_add_loop_test(tc, coded_rows_make_the_picture_of_the_others, 0,
                        N_ELEM(codings));
    tcase_add_loop_test(tc, coded_rows_that_are_none_are_refused, ROWS_CODED,
                        ROWS_RGBE + 1);
    tcase_add_test(tc, coded_rows_are_taken_apart_a_few_at_a_time);
    tcase_add_test(tc, a_line_keeps_its_floats);
    tcase_add_test(tc, store_keeps_files_and_refuses_impostors);
    tcase_add_test(tc, store_tells_of_every_chunk);
    tcase_add_test(tc, store_notices_damaged_files);
    tcase_add_loop_test(tc, files_are_read_behind_the_loop, 0, 2);
    tcase_add_test(tc, folder_serves_one_store);
    tcase_add_test(tc, without_a_database_jobs_go_and_files_stay);
    tcase_add_loop_test(tc, job_becomes_a_picture, 0, 2);
    tcase_add_test(tc, a_job_goes_on_in_another_life);
    tcase_add_test(tc, a_job_that_is_over_is_remembered_and_forgotten);
    tcase_add_loop_test(tc, a_damaged_folder_is_refused, 0, N_ELEM(damages));
    tcase_add_test(tc, a_units_base_line_outlives_the_store);
    tcase_add_loop_test(tc, rows_that_a_disk_has_spoilt_are_none, 0,
                        N_ELEM(spoilt));
    tcase_add_test(tc, files_that_no_job_needs_go_after_a_day);
    tcase_add_test(tc, sounds_of_very_many_files_are_forgotten);
    tcase_add_test(tc, folders_are_made_and_files_written_whole);
    tcase_add_test(tc, a_database_gets_its_name_when_it_is_whole);
    tcase_add_test(tc, previews_of_many_samples_are_of_those_in_the_middle);
    tcase_add_loop_test(tc, previews_show_colours_where_rows_are_missing, 0,
                        N_ELEM(shown));
    suite_add_tcase(s, tc);
    return unit_run(s);
}
