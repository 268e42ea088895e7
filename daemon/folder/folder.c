/* folder.c - see folder.h; jobs of earlier lives are folder_take.c's */
#include "config.h"

#include "folder/folder_impl.h"

#include "folder/filtered.h"
#include "machine/jobtext.h"
#include "folder/room.h"
#include "machine/rowsum.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ROOM_NAME      "room"
#define FORGET_AT_ONCE 1000                /* files */
static const char gone_suffix[] = ".gone"; /* of what is being forgotten */

/* --- names --- */

/* DIR/jobs/ID, or DIR/jobs/ID/FRAMEsuffix. */
void
folder_job_path(const struct folder *f, const uint8_t *id,
                char path[DISK_PATH_MAX])
{
    char hex[MSG_JOB_HEX];

    msg_job_format(id, hex);
    snprintf(path, DISK_PATH_MAX, "%s/jobs/%s", f->dir, hex);
}

void
folder_frame_path(const struct folder *f, const uint8_t *id, uint32_t frame,
                  const char *suffix, char path[DISK_PATH_MAX])
{
    size_t n;

    folder_job_path(f, id, path);
    n = strlen(path);
    snprintf(path + n, DISK_PATH_MAX - n, "/%u%s", frame, suffix);
}

/* Of what is kept for frames that are empty. */
void
folder_room_path(const struct folder *f, const uint8_t *id,
                 char path[DISK_PATH_MAX])
{
    folder_job_path(f, id, path);
    strncat(path, "/" ROOM_NAME, DISK_PATH_MAX - strlen(path) - 1);
}

void
folder_stats_path(const struct folder *f, const uint8_t *id,
                  char path[DISK_PATH_MAX])
{
    folder_job_path(f, id, path);
    strncat(path, "/stats", DISK_PATH_MAX - strlen(path) - 1);
}

/* DIR/jobs/ID.gone */
static void
gone_path(const struct folder *f, const uint8_t *id, char path[DISK_PATH_MAX])
{
    folder_job_path(f, id, path);
    strncat(path, gone_suffix, DISK_PATH_MAX - strlen(path) - 1);
}

/* DIR/jobs/ID/new */
static void
new_path(const struct folder *f, const uint8_t *id, char path[DISK_PATH_MAX])
{
    folder_job_path(f, id, path);
    strncat(path, "/new", DISK_PATH_MAX - strlen(path) - 1);
}

const char *
folder_suffix_of(enum msg_what what)
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
free_rows(struct frame_rows *r)
{
    if (r->rows)
        rows_release(r->rows);
    free(r->rows);
    r->rows = NULL;
}

void
folder_free_job(struct folder_job *j)
{
    if (!j)
        return;
    for (uint32_t i = 0; i < j->nframes; i++) {
        free_rows(&j->frames[i]);
        free(j->frames[i].view);
    }
    free(j->frames);
    free(j->params);
    free(j->origin);
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
    folder_free_job(j);
}

static bool
copy_frames(struct folder_job *j, const struct msg_spec *spec)
{
    for (uint32_t i = 0; i < spec->nframes; i++) {
        struct frame_rows *f = &j->frames[i];

        f->number = spec->frames[i].number;
        f->width = (int)spec->frames[i].width;
        f->height = (int)spec->frames[i].height;
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

struct folder_job *
folder_new_job(const struct folder *f, const struct msg_spec *spec,
               struct rad_error *err)
{
    struct folder_job *j = calloc(1, sizeof *j);

    if (j) {
        memcpy(j->id, spec->job, MSG_JOB);
        j->depth = spec->flags & MSG_JOB_DEPTH;
        j->oversample = spec->oversample > 1 ? spec->oversample : 1;
        j->clamp = spec->clamp;
        j->kind = kind_of(f, spec);
        j->params = strdup(spec->params);
        j->origin = strdup(spec->origin ? spec->origin : "");
        j->frames = calloc(spec->nframes, sizeof *j->frames);
        j->nframes = j->frames ? spec->nframes : 0;
        if (j->params && j->origin && j->frames && copy_frames(j, spec))
            return j;
    }
    folder_free_job(j);
    rad_fail(err, RAD_ENOMEM, "out of memory");
    return NULL;
}

void
folder_add_job(struct folder *f, struct folder_job *j)
{
    drop_job(f, j->id);
    j->next = f->jobs;
    f->jobs = j;
}

/* Bytes of the rows of a frame. */
uint64_t
folder_frame_bytes(const struct folder_job *j, const struct frame_rows *r)
{
    uint64_t floats = j->kind == ROWS_RGBE ? 1 : (uint64_t)j->kind;

    return (uint64_t)r->width * (uint64_t)r->height * floats * sizeof(float);
}

/* Make the file of a frame's rows, in room that was kept for it. */
static int
begin_frame(struct folder *f, struct folder_job *j, uint32_t i,
            struct rad_error *err)
{
    struct frame_rows *r = &j->frames[i];
    uint64_t room = f->durable ? j->room - folder_frame_bytes(j, r) : 0;
    char path[DISK_PATH_MAX];
    int rc = 0;

    r->rows = calloc(1, sizeof *r->rows);
    if (!r->rows)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if (f->durable) {
        folder_room_path(f, j->id, path);
        rc = room_set(path, room, err);
    }
    folder_frame_path(f, j->id, i, ".rows", path);
    if (rc == 0)
        rc = rows_create(r->rows, &f->opened, path, r->width, r->height,
                         j->kind, f->durable, err);
    if (rc < 0) {
        free(r->rows);
        r->rows = NULL;
        return rc;
    }
    j->room = room;
    j->new_files = true;
    r->state = FRAME_BEGUN;
    return 0;
}

/* A frame whose rows have a file, which is made if need be; or an error. */
static int
find_frame(struct folder *f, const uint8_t *id, uint32_t frame,
           struct folder_job **job, struct frame_rows **rows,
           struct rad_error *err)
{
    struct folder_job *j = *find(f, id);
    int rc = 0;

    if (!j || frame >= j->nframes || j->frames[frame].state == FRAME_WRITTEN)
        return rad_fail(err, RAD_ENOINPUT, "no rows of frame %u", frame);
    if (j->frames[frame].state == FRAME_EMPTY)
        rc = begin_frame(f, j, frame, err);
    if (rc < 0)
        return rc;
    *job = j;
    *rows = &j->frames[frame];
    return 0;
}

/* Remove so many of its files at most.  Is there more? */
static bool
empty_dir(const char *path, unsigned most)
{
    DIR *d = disk_open_dir(path);
    struct dirent *e;
    unsigned n = 0;

    if (!d)
        return false;
    while (n < most && (e = readdir(d)) != NULL)
        n += unlinkat(dirfd(d), e->d_name, 0) == 0;
    closedir(d);
    return n == most;
}

static void
remove_dir(const char *path)
{
    empty_dir(path, UINT_MAX);
    rmdir(path);
}

/* The folder, with what says that the database does not know it: that lasts
 * before there is anything else in it. */
static int
make_dir(const struct folder *f, const uint8_t *id, const char *path,
         struct rad_error *err)
{
    char name[DISK_PATH_MAX];
    int rc = disk_make_dir(path, err), fd;

    if (rc < 0 || !f->durable)
        return rc;
    new_path(f, id, name);
    fd = open(name, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0)
        return disk_fail(err, errno, "create", name);
    close(fd);
    return disk_sync_dir(path, err);
}

/* All frames are empty: may they have their room?  What a former call kept
 * counts. */
static int
check_room(const struct folder *f, struct folder_job *j, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    uint64_t there;

    for (uint32_t i = 0; i < j->nframes; i++)
        j->room += folder_frame_bytes(j, &j->frames[i]);
    folder_room_path(f, j->id, path);
    there = room_size(path);
    return room_check(f->dir, j->room > there ? j->room - there : 0, "its rows",
                      err);
}

static int
keep_room(const struct folder *f, const struct folder_job *j,
          struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc;

    folder_room_path(f, j->id, path);
    rc = room_set(path, j->room, err);
    if (rc == 0)
        rc = disk_sync_dir_of(path, err);
    folder_job_path(f, j->id, path);
    return rc == 0 ? disk_sync_dir_of(path, err) : rc;
}

int
folder_make(struct folder *f, const struct msg_spec *spec,
            struct rad_error *err)
{
    struct folder_job *j = folder_new_job(f, spec, err);
    char path[DISK_PATH_MAX];
    int rc;

    if (!j)
        return RAD_ENOMEM;
    folder_job_path(f, spec->job, path);
    rc = f->durable ? check_room(f, j, err) : 0;
    if (rc == 0)
        rc = make_dir(f, spec->job, path, err);
    if (rc == 0 && f->durable) /* else whoever needs it notices */
        rc = keep_room(f, j, err);
    if (rc == 0) {
        folder_add_job(f, j);
        return 0;
    }
    folder_free_job(j);
    remove_dir(path);
    return rc;
}

/* Rows and what was half written. */
static bool
is_left_over(const char *name)
{
    static const char *const suffix[] = { ".rows", ".preview", ".tmp" };
    size_t n = strlen(name);

    if (strcmp(name, ROOM_NAME) == 0)
        return true;
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
    folder_job_path(f, id, path);
    d = disk_open_dir(path);
    if (!d)
        return;
    while ((e = readdir(d)) != NULL)
        if (is_left_over(e->d_name))
            unlinkat(dirfd(d), e->d_name, 0);
    closedir(d);
}

bool
folder_forget(struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX], gone[DISK_PATH_MAX];

    drop_job(f, id);
    folder_job_path(f, id, path);
    gone_path(f, id, gone);
    return (rename(path, gone) == 0 || errno == ENOENT) &&
           empty_dir(gone, FORGET_AT_ONCE);
}

void
folder_forgotten(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    gone_path(f, id, path);
    rmdir(path);
}

static bool
is_dir(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

bool
folder_is_there(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    folder_job_path(f, id, path);
    return is_dir(path);
}

bool
folder_is_going(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    gone_path(f, id, path);
    return is_dir(path);
}

bool
folder_is_open(struct folder *f, const uint8_t id[MSG_JOB])
{
    return *find(f, id);
}

void
folder_noted(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    new_path(f, id, path);
    unlink(path);
}

static bool
is_empty(const char *path)
{
    DIR *d = disk_open_dir(path);
    struct dirent *e;
    bool empty = d;

    while (empty && (e = readdir(d)) != NULL)
        empty = strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0;
    if (d)
        closedir(d);
    return empty;
}

/* Also one with nothing in it: power was lost before there was. */
bool
folder_is_new(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct stat st;

    new_path(f, id, path);
    if (stat(path, &st) == 0)
        return true;
    folder_job_path(f, id, path);
    return is_empty(path);
}

uint64_t
folder_bytes(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct dirent *e;
    struct stat st;
    uint64_t n = 0;
    DIR *d;

    folder_job_path(f, id, path);
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
        return put_coded(r->rows, k, pixels, n, line, sum, err);
    if (k->channels != (int)r->rows->kind)
        return rad_fail(err, RAD_EPROTO, "rows of %d channels, expected %d",
                        k->channels, (int)r->rows->kind);
    rc = rows_write(r->rows, (int)k->x, (int)k->y, (int)k->width, (int)k->rows,
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
    line = r->rows->kind == ROWS_RGBE;
    n = line ? ROWS_LINE_BYTES(r->rows->width)
             : rows_bytes(r->rows, r->rows->width);
    row = malloc(n);
    if (!row)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = line ? rows_read_line(r->rows, (int)y, row, err)
              : rows_read(r->rows, (int)y, row, err);
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
    n = rows_bytes(r->rows, (int)a->width);
    row = malloc(n);
    if (!row)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (uint32_t i = 0; i < rows && rc == 0; i++) {
        rc = rows_read_part(r->rows, (int)a->x, (int)(a->y + i), (int)a->width,
                            row, err);
        if (rc == 0)
            *sum ^= rowsum(row, n, a->y + i, 1);
    }
    free(row);
    if (rc == 0 && line && rows > 0 && r->rows->kind == ROWS_RGBE)
        rc = sum_line(r->rows, a->y + rows - 1, sum, err);
    return rc;
}

int
folder_sync(struct folder *f, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc = rows_sync(&f->opened, err);

    for (struct folder_job *j = f->jobs; j && rc == 0; j = j->next) {
        if (!j->new_files)
            continue;
        folder_job_path(f, j->id, path);
        rc = disk_sync_dir(path, err);
        j->new_files = rc < 0;
    }
    return rc;
}

/* --- pictures --- */

/* How its rows become the picture. */
static int
shape_of(const struct folder_job *j, const struct frame_rows *f,
         struct rad_filter_shape *shape, struct rad_error *err)
{
    return filtered_shape(shape, f->width, f->height, j->oversample, j->clamp,
                          f->view, err);
}

/* A picture of the rows so far. */
static int
write_rgbe(const struct folder_job *j, struct frame_rows *f, const char *path,
           bool preview, bool durable, struct mark *mark, struct rad_error *err)
{
    struct rad_hdr_info info = { .origin = j->origin,
                                 .software = "radd " PACKAGE_VERSION,
                                 .program = "radsubmit",
                                 .options = j->params,
                                 .view = f->view,
                                 .frame = f->number,
                                 .width = f->width,
                                 .height = f->height };
    char options[RAD_FILTER_OPTIONS];
    struct rad_filter_shape shape;

    int rc = jobtext_pixaspect(j->params, f->view, f->width, f->height,
                               &info.pixaspect, err);

    if (rc < 0)
        return rc;
    if (j->oversample == 1)
        return rows_picture(f->rows, &info, path, durable, mark, err);
    rc = shape_of(j, f, &shape, err);
    if (rc == 0)
        rc = jobtext_options(j->params, j->oversample, j->clamp, options, err);
    if (rc < 0)
        return rc;
    info.options = options;
    info.width = rad_filter_side(f->width, j->oversample);
    info.height = rad_filter_side(f->height, j->oversample);
    info.pixaspect = rad_filter_pixaspect(&shape, info.pixaspect);
    if (preview)
        return filtered_preview(f->rows, &shape, &info, path, err);
    return filtered_picture(f->rows, &shape, &info, path, durable, mark, err);
}

static int
write_depth(const struct folder_job *j, struct frame_rows *f, const char *path,
            bool durable, struct mark *mark, struct rad_error *err)
{
    struct rad_filter_shape shape;
    int rc;

    if (j->oversample == 1)
        return rows_depth(f->rows, path, durable, mark, err);
    rc = shape_of(j, f, &shape, err);
    if (rc < 0)
        return rc;
    return filtered_depth(f->rows, &shape, path, durable, mark, err);
}

int
folder_picture(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame,
               struct saved_frame *marks, struct rad_error *err)
{
    struct frame_rows *r;
    struct folder_job *j;
    char path[DISK_PATH_MAX];
    int rc = find_frame(f, id, frame, &j, &r, err);

    if (rc == 0 && j->depth) {
        folder_frame_path(f, id, frame, folder_suffix_of(MSG_WHAT_DEPTH), path);
        rc = write_depth(j, r, path, f->durable, marks ? &marks->depth : NULL,
                         err);
    }
    if (rc < 0)
        return rc;
    folder_frame_path(f, id, frame, folder_suffix_of(MSG_WHAT_PICTURE), path);
    return write_rgbe(j, r, path, false, f->durable,
                      marks ? &marks->picture : NULL, err);
}

void
folder_drop_rows(struct folder *f, const uint8_t id[MSG_JOB], uint32_t frame)
{
    struct folder_job *j = *find(f, id);
    struct frame_rows *r = j && frame < j->nframes ? &j->frames[frame] : NULL;

    if (!r || r->state != FRAME_BEGUN)
        return;
    rows_remove(r->rows);
    free_rows(r);
    r->state = FRAME_WRITTEN;
}

int
folder_stats(struct folder *f, const uint8_t id[MSG_JOB], const char *text,
             size_t len, struct mark *mark, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct disk_file w;
    int rc;

    folder_stats_path(f, id, path);
    rc = disk_file_open(&w, path, mark, err);
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
    struct rad_error why = { 0 };
    struct frame_rows *r;
    struct folder_job *j;
    int rc;

    if (what == MSG_WHAT_STATS) {
        folder_stats_path(f, id, path);
        return 0;
    }
    if (what != MSG_WHAT_PREVIEW) {
        folder_frame_path(f, id, frame, folder_suffix_of(what), path);
        return 0;
    }
    rc = find_frame(f, id, frame, &j, &r, &why);
    if (rc ==
        RAD_ENOINPUT) { /* its rows are gone: the picture is the preview */
        folder_frame_path(f, id, frame, folder_suffix_of(MSG_WHAT_PICTURE),
                          path);
        return 0;
    }
    if (rc < 0)
        return rad_fail(err, rc, "%s", why.what);
    folder_frame_path(f, id, frame, folder_suffix_of(what), path);
    return make ? write_rgbe(j, r, path, true, false, NULL, err) : 0;
}

/* --- the whole --- */

/* The job of a name in jobs/; false: it is none. */
static bool
parse_name(const char *name, uint8_t id[MSG_JOB], bool *going)
{
    char hex[MSG_JOB_HEX];
    size_t n = sizeof hex - 1;

    *going = strlen(name) > n && strcmp(name + n, gone_suffix) == 0;
    if (!*going)
        return msg_job_parse(name, id);
    memcpy(hex, name, n);
    hex[n] = '\0';
    return msg_job_parse(hex, id);
}

int
folder_each(const struct folder *f, folder_fn *fn, void *arg,
            struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    uint8_t id[MSG_JOB];
    struct dirent *e;
    bool going;
    int rc = 0;
    DIR *d;

    snprintf(path, sizeof path, "%s/jobs", f->dir);
    d = disk_open_dir(path);
    if (!d)
        return errno == ENOENT ? 0 : disk_fail(err, errno, "open", path);
    while (rc == 0 && (e = readdir(d)) != NULL)
        if (parse_name(e->d_name, id, &going))
            rc = fn(arg, id, going, err);
    closedir(d);
    return rc;
}

static int
remove_one(void *arg, const uint8_t id[MSG_JOB], bool going,
           struct rad_error *err)
{
    (void)going;
    (void)err;
    while (folder_forget(arg, id))
        ;
    folder_forgotten(arg, id);
    return 0;
}

int
folder_init(struct folder *f, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc;

    snprintf(path, sizeof path, "%s/jobs", f->dir);
    rc = disk_make_dir(path, err);
    /* jobs that live in memory are nobody's any more */
    return rc == 0 && !f->durable ? folder_each(f, remove_one, f, err) : rc;
}

void
folder_release(struct folder *f)
{
    while (f->jobs) {
        struct folder_job *j = f->jobs;

        f->jobs = j->next;
        folder_free_job(j);
    }
    syncs_release(&f->opened.closed);
}
