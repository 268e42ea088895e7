/* folder.c - see folder.h */
#include "config.h"

#include "folder.h"

#include "jobtext.h"
#include "rows.h"
#include "rowsum.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

struct frame_rows {
    struct rows rows;
    char *view;
    uint32_t number;
    bool open; /* rows are there */
};

struct folder_job {
    struct folder_job *next;
    uint8_t id[MSG_JOB];
    char *params;
    bool depth;
    enum rows_kind kind;
    uint32_t nframes;
    struct frame_rows *frames;
};

static const char gone_suffix[] = ".gone"; /* of what is being forgotten */

/* --- names --- */

/* DIR/jobs/ID, or DIR/jobs/ID/FRAMEsuffix. */
static void
job_path(const struct folder *f, const uint8_t *id, char path[DISK_PATH_MAX])
{
    char hex[MSG_JOB_HEX];

    msg_job_format(id, hex);
    snprintf(path, DISK_PATH_MAX, "%s/jobs/%s", f->dir, hex);
}

static void
frame_path(const struct folder *f, const uint8_t *id, uint32_t frame,
           const char *suffix, char path[DISK_PATH_MAX])
{
    size_t n;

    job_path(f, id, path);
    n = strlen(path);
    snprintf(path + n, DISK_PATH_MAX - n, "/%u%s", frame, suffix);
}

static void
stats_path(const struct folder *f, const uint8_t *id, char path[DISK_PATH_MAX])
{
    job_path(f, id, path);
    strncat(path, "/stats", DISK_PATH_MAX - strlen(path) - 1);
}

static const char *
suffix_of(enum msg_what what)
{
    return what == MSG_WHAT_PICTURE ? ".hdr"
           : what == MSG_WHAT_DEPTH ? ".z"
                                    : ".preview";
}

/* --- jobs --- */

static struct folder_job **
find(struct folder *f, const uint8_t *id)
{
    struct folder_job **at = &f->jobs;

    while (*at && memcmp((*at)->id, id, MSG_JOB) != 0)
        at = &(*at)->next;
    return at;
}

static void
free_job(struct folder_job *j)
{
    if (!j)
        return;
    for (uint32_t i = 0; i < j->nframes; i++) {
        if (j->frames[i].open)
            rows_release(&j->frames[i].rows);
        free(j->frames[i].view);
    }
    free(j->frames);
    free(j->params);
    free(j);
}

/* Forget it, but for its files. */
static void
drop_job(struct folder *f, const uint8_t *id)
{
    struct folder_job **at = find(f, id), *j = *at;

    if (!j)
        return;
    *at = j->next;
    free_job(j);
}

static bool
copy_frames(struct folder_job *j, const struct msg_spec *spec)
{
    for (uint32_t i = 0; i < spec->nframes; i++) {
        struct frame_rows *f = &j->frames[i];

        f->number = spec->frames[i].number;
        f->rows.fd = -1;
        f->rows.width = (int)spec->frames[i].width;
        f->rows.height = (int)spec->frames[i].height;
        f->view = strdup(spec->frames[i].view);
        if (!f->view)
            return false;
    }
    return true;
}

/* Coded rows as they come are for who has but one life; those of windows are
 * parts of the picture's. */
static enum rows_kind
kind_of(const struct folder *f, const struct msg_spec *spec)
{
    if (!(spec->flags & MSG_JOB_CODED))
        return spec->flags & MSG_JOB_DEPTH ? ROWS_DISTANCES : ROWS_COLOURS;
    return f->durable || spec->partition == MSG_PART_WINDOW ? ROWS_RGBE
                                                            : ROWS_CODED;
}

static struct folder_job *
new_job(const struct folder *f, const struct msg_spec *spec,
        struct rad_error *err)
{
    struct folder_job *j = calloc(1, sizeof *j);

    if (j) {
        memcpy(j->id, spec->job, MSG_JOB);
        j->depth = spec->flags & MSG_JOB_DEPTH;
        j->kind = kind_of(f, spec);
        j->params = strdup(spec->params);
        j->frames = calloc(spec->nframes, sizeof *j->frames);
        j->nframes = j->frames ? spec->nframes : 0;
        if (j->params && j->frames && copy_frames(j, spec))
            return j;
    }
    free_job(j);
    rad_fail(err, RAD_ENOMEM, "out of memory");
    return NULL;
}

static void
add_job(struct folder *f, struct folder_job *j)
{
    drop_job(f, j->id);
    j->next = f->jobs;
    f->jobs = j;
}

/* The rows of a frame, or an error. */
static int
find_frame(struct folder *f, const uint8_t *id, uint32_t frame,
           struct folder_job **job, struct frame_rows **rows,
           struct rad_error *err)
{
    struct folder_job *j = *find(f, id);

    if (!j || frame >= j->nframes || !j->frames[frame].open)
        return rad_fail(err, RAD_ENOINPUT, "no rows of frame %u", frame);
    *job = j;
    *rows = &j->frames[frame];
    return 0;
}

static int
make_rows(struct folder *f, struct folder_job *j, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc = 0;

    for (uint32_t i = 0; i < j->nframes && rc == 0; i++) {
        struct frame_rows *r = &j->frames[i];

        frame_path(f, j->id, i, ".rows", path);
        rc = rows_create(&r->rows, path, r->rows.width, r->rows.height, j->kind,
                         f->durable, err);
        r->open = rc == 0;
    }
    return rc;
}

static void
remove_dir(const char *path)
{
    DIR *d = disk_open_dir(path);
    struct dirent *e;

    if (!d)
        return;
    while ((e = readdir(d)) != NULL)
        unlinkat(dirfd(d), e->d_name, 0);
    closedir(d);
    rmdir(path);
}

/* One that can never have its room must not wait for it, for all that writes
 * would wait as well. */
static int
check_size(const struct folder *f, const struct folder_job *j,
           struct rad_error *err)
{
    struct statvfs fs;
    uint64_t all, need = 0;

    if (!f->durable || statvfs(f->dir, &fs) < 0)
        return 0; /* whoever needs the room notices */
    for (uint32_t i = 0; i < j->nframes; i++) {
        const struct rows *r = &j->frames[i].rows;
        uint64_t floats = j->kind == ROWS_RGBE ? 1 : (uint64_t)j->kind;

        need +=
            (uint64_t)r->width * (uint64_t)r->height * floats * sizeof(float);
    }
    all = (uint64_t)fs.f_blocks * fs.f_frsize;
    if (all == 0 || need <= all) /* 0: it does not say */
        return 0;
    return rad_fail(err, RAD_EDATA,
                    "its rows need %" PRIu64 " MiB, and the coordinator's disk "
                    "has %" PRIu64 " in all",
                    need >> 20, all >> 20);
}

int
folder_make(struct folder *f, const struct msg_spec *spec,
            struct rad_error *err)
{
    struct folder_job *j = new_job(f, spec, err);
    char path[DISK_PATH_MAX];
    int rc;

    if (!j)
        return RAD_ENOMEM;
    rc = check_size(f, j, err);
    if (rc < 0) {
        free_job(j);
        return rc;
    }
    job_path(f, spec->job, path);
    rc = disk_make_dir(path, err);
    if (rc == 0)
        rc = make_rows(f, j, err);
    if (rc == 0 && f->durable)
        rc = disk_sync_dir(path, err);
    if (rc == 0 && f->durable)
        rc = disk_sync_dir_of(path, err);
    if (rc < 0) {
        free_job(j);
        remove_dir(path);
        return rc;
    }
    add_job(f, j);
    return 0;
}

static bool
is_file(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0;
}

/* The picture that is said to be there. */
static int
check_picture(const struct folder *f, const struct msg_spec *spec, uint32_t i,
              struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct stat st;
    off_t size = (off_t)spec->frames[i].width * spec->frames[i].height * 4;

    frame_path(f, spec->job, i, suffix_of(MSG_WHAT_PICTURE), path);
    if (!is_file(path))
        return rad_fail(err, RAD_EDATA, "picture '%s' is missing", path);
    if (!(spec->flags & MSG_JOB_DEPTH))
        return 0;
    frame_path(f, spec->job, i, suffix_of(MSG_WHAT_DEPTH), path);
    if (stat(path, &st) < 0 || st.st_size != size)
        return rad_fail(err, RAD_EDATA,
                        "distances '%s' are missing, or not whole", path);
    return 0;
}

static int
take_rows(const struct folder *f, struct folder_job *j, uint32_t i,
          struct rad_error *err)
{
    struct frame_rows *r = &j->frames[i];
    char path[DISK_PATH_MAX];
    int rc;

    frame_path(f, j->id, i, ".rows", path);
    rc = rows_open(&r->rows, path, r->rows.width, r->rows.height, j->kind, err);
    r->open = rc == 0;
    return rc;
}

int
folder_take_up(struct folder *f, const struct saved_job *s, bool over,
               struct rad_error *err)
{
    struct folder_job *j = new_job(f, &s->spec, err);
    int rc = 0;

    if (!j)
        return RAD_ENOMEM;
    for (uint32_t i = 0; i < j->nframes && rc == 0; i++) {
        if (s->written[i])
            rc = check_picture(f, &s->spec, i, err);
        else if (!over)
            rc = take_rows(f, j, i, err);
    }
    if (rc < 0 || over)
        free_job(j);
    else
        add_job(f, j);
    return rc;
}

/* Rows and what was half written. */
static bool
is_left_over(const char *name)
{
    static const char *const suffix[] = { ".rows", ".preview", ".tmp" };
    size_t n = strlen(name);

    for (size_t i = 0; i < sizeof suffix / sizeof suffix[0]; i++) {
        size_t m = strlen(suffix[i]);

        if (n > m && strcmp(name + n - m, suffix[i]) == 0)
            return true;
    }
    return false;
}

void
folder_rest(struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct dirent *e;
    DIR *d;

    drop_job(f, id);
    job_path(f, id, path);
    d = disk_open_dir(path);
    if (!d)
        return;
    while ((e = readdir(d)) != NULL)
        if (is_left_over(e->d_name))
            unlinkat(dirfd(d), e->d_name, 0);
    closedir(d);
}

void
folder_forget(struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX], gone[DISK_PATH_MAX + 8];

    drop_job(f, id);
    job_path(f, id, path);
    snprintf(gone, sizeof gone, "%s%s", path, gone_suffix);
    if (rename(path, gone) == 0)
        remove_dir(gone);
}

bool
folder_is_there(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct stat st;

    job_path(f, id, path);
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

uint64_t
folder_bytes(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct dirent *e;
    struct stat st;
    uint64_t n = 0;
    DIR *d;

    job_path(f, id, path);
    d = disk_open_dir(path);
    if (!d)
        return 0;
    while ((e = readdir(d)) != NULL)
        if (fstatat(dirfd(d), e->d_name, &st, 0) == 0 && S_ISREG(st.st_mode))
            n += (uint64_t)st.st_blocks * 512;
    closedir(d);
    return n;
}

/* --- rows --- */

static int
put_coded(struct rows *r, const struct action_rows *k, const void *pixels,
          size_t n, const float *line, uint64_t *sum, struct rad_error *err)
{
    uint32_t last = k->y + k->rows - 1;
    int rc = rows_write_coded(r, (int)k->x, (int)k->y, (int)k->width,
                              (int)k->rows, pixels, n, sum, err);

    if (rc == 0 && line)
        rc = rows_write_line(r, (int)last, line, err);
    if (rc == 0 && line && sum)
        *sum ^= rowsum(line, ROWS_LINE_BYTES(r->width), last, 1);
    return rc;
}

int
folder_put_rows(struct folder *f, const struct action_rows *k,
                const void *pixels, size_t n, const float *line, uint64_t *sum,
                struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;
    int rc = find_frame(f, k->job, k->frame, &j, &r, err);

    if (rc < 0)
        return rc;
    if (k->channels == 1)
        return put_coded(&r->rows, k, pixels, n, line, sum, err);
    if (k->channels != (int)r->rows.kind)
        return rad_fail(err, RAD_EPROTO, "rows of %d channels, expected %d",
                        k->channels, (int)r->rows.kind);
    rc = rows_write(&r->rows, (int)k->x, (int)k->y, (int)k->width, (int)k->rows,
                    pixels, err);
    if (rc == 0 && sum)
        *sum = rowsum(pixels, n / k->rows, k->y, k->rows);
    return rc;
}

int
folder_read_row(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
                uint32_t y, uint8_t *pixels, struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;
    int rc = find_frame(f, id, frame, &j, &r, err);
    bool line;
    float *row;
    size_t n;

    if (rc < 0)
        return rc;
    line = r->rows.kind == ROWS_RGBE;
    n = line ? ROWS_LINE_BYTES(r->rows.width)
             : rows_bytes(&r->rows, r->rows.width);
    row = malloc(n);
    if (!row)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = line ? rows_read_line(&r->rows, (int)y, row, err)
              : rows_read(&r->rows, (int)y, row, err);
    if (rc == 0)
        wire_floats_put(pixels, row, n / sizeof *row);
    free(row);
    return rc;
}

/* Add the sum of a line. */
static int
sum_line(struct rows *r, uint32_t y, uint64_t *sum, struct rad_error *err)
{
    float *line = malloc(ROWS_LINE_BYTES(r->width));
    int rc = line ? rows_read_line(r, (int)y, line, err)
                  : rad_fail(err, RAD_ENOMEM, "out of memory");

    if (rc == 0)
        *sum ^= rowsum(line, ROWS_LINE_BYTES(r->width), y, 1);
    free(line);
    return rc;
}

int
folder_sum(struct folder *f, const uint8_t id[MSG_JOB],
           const struct partition_area *a, uint32_t rows, bool line,
           uint64_t *sum, struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;
    int rc = find_frame(f, id, a->frame, &j, &r, err);
    void *row;
    size_t n;

    *sum = 0;
    if (rc < 0)
        return rc;
    n = rows_bytes(&r->rows, (int)a->width);
    row = malloc(n);
    if (!row)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (uint32_t i = 0; i < rows && rc == 0; i++) {
        rc = rows_read_part(&r->rows, (int)a->x, (int)(a->y + i), (int)a->width,
                            row, err);
        if (rc == 0)
            *sum ^= rowsum(row, n, a->y + i, 1);
    }
    free(row);
    if (rc == 0 && line && rows > 0 && r->rows.kind == ROWS_RGBE)
        rc = sum_line(&r->rows, a->y + rows - 1, sum, err);
    return rc;
}

int
folder_sync(struct folder *f, struct rad_error *err)
{
    int rc = 0;

    for (struct folder_job *j = f->jobs; j && rc == 0; j = j->next)
        for (uint32_t i = 0; i < j->nframes && rc == 0; i++)
            if (j->frames[i].open)
                rc = rows_sync(&j->frames[i].rows, err);
    return rc;
}

/* --- pictures --- */

/* A picture of the rows so far. */
static int
write_rgbe(const struct folder_job *j, struct frame_rows *f, const char *path,
           bool durable, struct rad_error *err)
{
    struct rad_hdr_info info = { .program = "radsubmit",
                                 .options = j->params,
                                 .view = f->view,
                                 .frame = f->number,
                                 .width = f->rows.width,
                                 .height = f->rows.height };

    int rc = jobtext_pixaspect(j->params, f->view, f->rows.width,
                               f->rows.height, &info.pixaspect, err);

    if (rc < 0)
        return rc;
    return rows_picture(&f->rows, &info, path, durable, err);
}

int
folder_picture(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
               struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;
    char path[DISK_PATH_MAX];
    int rc = find_frame(f, id, frame, &j, &r, err);

    if (rc == 0 && j->depth) {
        frame_path(f, id, frame, suffix_of(MSG_WHAT_DEPTH), path);
        rc = rows_depth(&r->rows, path, f->durable, err);
    }
    if (rc < 0)
        return rc;
    frame_path(f, id, frame, suffix_of(MSG_WHAT_PICTURE), path);
    return write_rgbe(j, r, path, f->durable, err);
}

void
folder_drop_rows(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame)
{
    struct frame_rows *r;
    struct folder_job *j;

    if (find_frame(f, id, frame, &j, &r, NULL) < 0)
        return;
    rows_remove(&r->rows);
    r->open = false;
}

int
folder_stats(struct folder *f, const uint8_t id[MSG_JOB], const char *text,
             size_t len, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct disk_file w;
    int rc;

    stats_path(f, id, path);
    rc = disk_file_open(&w, path, err);
    if (rc < 0)
        return rc;
    rc = disk_file_write(&w, text, len, err);
    return disk_file_close(&w, rc, f->durable, err);
}

int
folder_find(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
            enum msg_what what, bool make, char path[DISK_PATH_MAX],
            struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;

    if (what == MSG_WHAT_STATS) {
        stats_path(f, id, path);
        return 0;
    }
    frame_path(f, id, frame, suffix_of(what), path);
    if (what != MSG_WHAT_PREVIEW)
        return 0;
    /* once the rows are gone, the picture is the preview */
    if (find_frame(f, id, frame, &j, &r, NULL) < 0) {
        frame_path(f, id, frame, suffix_of(MSG_WHAT_PICTURE), path);
        return 0;
    }
    return make ? write_rgbe(j, r, path, false, err) : 0;
}

/* --- the whole --- */

int
folder_each(const struct folder *f,
            int (*fn)(void *arg, const uint8_t job[MSG_JOB],
                      struct rad_error *err),
            void *arg, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    uint8_t id[MSG_JOB];
    struct dirent *e;
    int rc = 0;
    DIR *d;

    snprintf(path, sizeof path, "%s/jobs", f->dir);
    d = disk_open_dir(path);
    if (!d)
        return errno == ENOENT ? 0 : disk_fail(err, errno, "open", path);
    while (rc == 0 && (e = readdir(d)) != NULL)
        if (msg_job_parse(e->d_name, id))
            rc = fn(arg, id, err);
    closedir(d);
    return rc;
}

static void
sweep(const char *jobs)
{
    char path[DISK_PATH_MAX];
    struct dirent *e;
    DIR *d = disk_open_dir(jobs);

    if (!d)
        return;
    while ((e = readdir(d)) != NULL) {
        size_t n = strlen(e->d_name), m = sizeof gone_suffix - 1;

        if (n <= m || strcmp(e->d_name + n - m, gone_suffix) != 0 ||
            snprintf(path, sizeof path, "%s/%s", jobs, e->d_name) >=
                (int)sizeof path)
            continue;
        remove_dir(path);
    }
    closedir(d);
}

int
folder_init(struct folder *f, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc;

    snprintf(path, sizeof path, "%s/jobs", f->dir);
    rc = disk_make_dir(path, err);
    sweep(path);
    return rc;
}

void
folder_release(struct folder *f)
{
    while (f->jobs) {
        struct folder_job *j = f->jobs;

        f->jobs = j->next;
        free_job(j);
    }
}
