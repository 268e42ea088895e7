/* folder.c - see folder.h: jobs and their folders
 *
 * folder_rows.c writes rows, folder_picture.c pictures, and folder_cache.c
 * ambient caches; folder_take.c takes up jobs of earlier lives. */
#include "config.h"

#include "folder/folder_impl.h"

#include "folder/room.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FORGET_AT_ONCE 1000 /* files in one call of folder_forget() */

/* --- names --- */

void
folder_path(const struct folder *f, const uint8_t *id, const char *suffix,
            char path[DISK_PATH_MAX])
{
    char hex[MSG_JOB_HEX];

    msg_job_format(id, hex);
    snprintf(path, DISK_PATH_MAX, "%s/jobs/%s%s", f->dir, hex, suffix);
}

void
folder_frame_path(const struct folder *f, const uint8_t *id, uint32_t frame,
                  const char *suffix, char path[DISK_PATH_MAX])
{
    char name[32];

    snprintf(name, sizeof name, "/%u%s", frame, suffix);
    folder_path(f, id, name, path);
}

const char *
folder_suffix_of(enum msg_what what)
{
    return what == MSG_WHAT_PICTURE ? ".hdr"
           : what == MSG_WHAT_DEPTH ? ".z"
                                    : ".preview";
}

/* --- jobs --- */

struct folder_job **
folder_find_job(struct folder *f, const uint8_t *id)
{
    struct folder_job **at = &f->jobs[msg_job_chain(id, FOLDER_CHAINS)];

    while (*at && memcmp((*at)->id, id, MSG_JOB) != 0)
        at = &(*at)->next;
    return at;
}

void
folder_free_rows(struct frame_rows *r)
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
        folder_free_rows(&j->frames[i]);
        free(j->frames[i].view);
    }
    free(j->frames);
    free(j->params);
    free(j->origin);
    free(j);
}

/* Free the job, but leave its files. */
static void
drop_job(struct folder *f, const uint8_t *id)
{
    struct folder_job **at = folder_find_job(f, id), *j = *at;
    struct folder_job **changed = &f->changed;

    if (!j)
        return;
    *at = j->next;
    while (*changed && *changed != j)
        changed = &(*changed)->changed;
    if (*changed)
        *changed = j->changed;
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

/* Coded rows stay coded if jobs end with the process, which remembers where
 * each row lies; but not rows of windows, which are parts of the picture's
 * rows. */
static enum rows_kind
kind_of(const struct folder *f, const struct msg_spec *spec)
{
    if (!(spec->flags & MSG_JOB_CODED))
        return spec->flags & MSG_JOB_DEPTH ? ROWS_DISTANCES : ROWS_COLOURS;
    return !f->durable && msg_shares_lines(spec->partition) ? ROWS_CODED
                                                            : ROWS_RGBE;
}

struct folder_job *
folder_new_job(const struct folder *f, const struct msg_spec *spec,
               struct rad_error *err)
{
    struct folder_job *j = calloc(1, sizeof *j);

    if (j) {
        memcpy(j->id, spec->job, MSG_JOB);
        j->depth = spec->flags & MSG_JOB_DEPTH;
        j->points = spec->flags & MSG_JOB_POINTS;
        j->oversample = msg_oversample(spec);
        j->clamp = spec->clamp;
        j->edges = spec->flags & MSG_JOB_EDGES;
        j->kind = kind_of(f, spec);
        j->params = strdup(spec->params);
        j->origin = strdup(spec->origin ? spec->origin : "");
        j->frames = calloc(spec->nframes, sizeof *j->frames);
        j->nframes = j->frames ? spec->nframes : 0;
        if (j->params && j->origin && j->frames && copy_frames(j, spec))
            return j;
    }
    folder_free_job(j);
    rad_fail_memory(err);
    return NULL;
}

void
folder_add_job(struct folder *f, struct folder_job *j)
{
    struct folder_job **at;

    drop_job(f, j->id);
    at = folder_find_job(f, j->id);
    j->next = *at;
    *at = j;
}

uint64_t
folder_frame_bytes(const struct folder_job *j, const struct frame_rows *r)
{
    uint64_t floats = j->kind == ROWS_RGBE ? 1 : (uint64_t)j->kind;

    return (uint64_t)r->width * (uint64_t)r->height * floats * sizeof(float);
}

/* Remove at most so many files of the folder; true: there may be more. */
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

/* Is there room for the rows of all frames?  Room that an earlier call kept
 * counts as free. */
static int
check_room(const struct folder *f, struct folder_job *j, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    uint64_t there;

    for (uint32_t i = 0; i < j->nframes; i++)
        j->room += folder_frame_bytes(j, &j->frames[i]);
    folder_path(f, j->id, FOLDER_NEW, path);
    there = room_size(path);
    return room_check(f->dir, j->room > there ? j->room - there : 0, "its rows",
                      err);
}

/* Keep room in the file "new", the only file of the folder until the database
 * knows the job.  folder_sync() syncs file, folder and name. */
static int
keep_room(struct folder *f, const struct folder_job *j, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    int rc;

    folder_path(f, j->id, FOLDER_NEW, path);
    rc = room_set(path, j->room, err);
    if (rc == 0)
        rc = syncs_add(&f->opened.closed, path, true, err);
    f->renamed = true;
    return rc;
}

/* Try once more to remove files of an earlier job of this id.  If they stay, so
 * would the files of this job when it is forgotten. */
static int
check_gone(const struct folder *f, const uint8_t *id, struct rad_error *err)
{
    char path[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_GONE, path);
    remove_dir(path);
    if (access(path, F_OK) < 0)
        return 0;
    return rad_fail(err, RAD_ETEMPFAIL,
                    "files of an earlier job of this id cannot be removed: "
                    "submit it again");
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
    folder_path(f, spec->job, "", path);
    rc = check_gone(f, spec->job, err);
    if (rc == 0 && f->durable)
        rc = check_room(f, j, err);
    if (rc == 0)
        rc = disk_make_dir(path, err);
    if (rc == 0 && f->durable) /* if not, a full disk shows when rows come */
        rc = keep_room(f, j, err);
    if (rc == 0) {
        folder_add_job(f, j);
        return 0;
    }
    folder_free_job(j);
    remove_dir(path);
    return rc;
}

/* Is the file needless once the job is over: rows, a preview, room, the cache,
 * a file that is half written, or "over"? */
static bool
is_left_over(const char *name)
{
    static const char *const suffix[] = { ".rows", ".preview", ".tmp" };
    size_t n = strlen(name);

    if (strcmp(name, &FOLDER_ROOM[1]) == 0 ||
        strcmp(name, &FOLDER_CACHE[1]) == 0 ||
        strcmp(name, &FOLDER_OVER[1]) == 0)
        return true;
    for (size_t i = 0; i < sizeof suffix / sizeof suffix[0]; i++) {
        size_t m = strlen(suffix[i]);

        if (n > m && strcmp(name + n - m, suffix[i]) == 0)
            return true;
    }
    return false;
}

/* Remove the files that the job needs no more, but for the one of that name. */
static void
remove_rest(const struct folder *f, const uint8_t *id, const char *stays)
{
    char path[DISK_PATH_MAX];
    struct dirent *e;
    DIR *d;

    folder_path(f, id, "", path);
    d = disk_open_dir(path);
    if (!d)
        return;
    while ((e = readdir(d)) != NULL)
        if (is_left_over(e->d_name) && strcmp(e->d_name, stays) != 0)
            unlinkat(dirfd(d), e->d_name, 0);
    closedir(d);
}

void
folder_rest(struct folder *f, const uint8_t id[MSG_JOB])
{
    drop_job(f, id);
    remove_rest(f, id, "");
}

/* Rename a file of the job's rows, or the room for them, to "over", which needs
 * no room, and make that last before any file is removed.  A job that has
 * neither has all pictures, and needs no "over". */
static int
mark_over(const struct folder *f, const struct folder_job *j)
{
    char path[DISK_PATH_MAX], over[DISK_PATH_MAX];
    uint32_t i = 0;

    while (i < j->nframes && j->frames[i].file != FILE_ROWS)
        i++;
    if (i < j->nframes)
        folder_frame_path(f, j->id, i, ".rows", path);
    else
        folder_path(f, j->id, FOLDER_ROOM, path);
    folder_path(f, j->id, FOLDER_OVER, over);
    if (rename(path, over) < 0)
        return errno == ENOENT ? 0 : RAD_EIO;
    folder_path(f, j->id, "", path);
    return disk_sync_path(path, NULL) < 0 || truncate(over, 0) < 0 ? RAD_EIO
                                                                   : 0;
}

void
folder_give_up(struct folder *f, const uint8_t id[MSG_JOB])
{
    const struct folder_job *j = *folder_find_job(f, id);

    if (!j || folder_is_new(f, id) || mark_over(f, j) < 0)
        return;
    drop_job(f, id);
    remove_rest(f, id, &FOLDER_OVER[1]);
}

bool
folder_is_given_up(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_OVER, path);
    return access(path, F_OK) == 0;
}

bool
folder_forget(struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX], gone[DISK_PATH_MAX];

    drop_job(f, id);
    folder_path(f, id, "", path);
    folder_path(f, id, FOLDER_GONE, gone);
    if (rename(path, gone) == 0)
        f->renamed = true;
    else if (errno != ENOENT)
        return false;
    return empty_dir(gone, FORGET_AT_ONCE);
}

void
folder_forgotten(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_GONE, path);
    remove_dir(path);
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

    folder_path(f, id, "", path);
    return is_dir(path);
}

bool
folder_is_going(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_GONE, path);
    return is_dir(path) && !folder_is_there(f, id);
}

bool
folder_is_open(struct folder *f, const uint8_t id[MSG_JOB])
{
    return *folder_find_job(f, id);
}

void
folder_noted(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX], room[DISK_PATH_MAX];

    folder_path(f, id, FOLDER_NEW, path);
    folder_path(f, id, FOLDER_ROOM, room);
    if (access(room, F_OK) == 0) /* there was a crash */
        unlink(path);
    else
        rename(path, room);
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

/* An empty folder is new, too: power was lost before "new" was in it. */
bool
folder_is_new(const struct folder *f, const uint8_t id[MSG_JOB])
{
    char path[DISK_PATH_MAX];
    struct stat st;

    folder_path(f, id, FOLDER_NEW, path);
    if (stat(path, &st) == 0)
        return true;
    folder_path(f, id, "", path);
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

    folder_path(f, id, "", path);
    d = disk_open_dir(path);
    if (!d)
        return 0;
    while ((e = readdir(d)) != NULL)
        if (!is_left_over(e->d_name) &&
            fstatat(dirfd(d), e->d_name, &st, 0) == 0 && S_ISREG(st.st_mode))
            n += (uint64_t)st.st_blocks * 512;
    closedir(d);
    return n;
}

/* --- the whole --- */

/* Parse a name in jobs/; false: it is no job's. */
static bool
parse_name(const char *name, uint8_t id[MSG_JOB], bool *going)
{
    char hex[MSG_JOB_HEX];
    size_t n = sizeof hex - 1;

    *going = strlen(name) > n && strcmp(name + n, FOLDER_GONE) == 0;
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
    /* not durable: jobs that are there ended with their process */
    return rc == 0 && !f->durable ? folder_each(f, remove_one, f, err) : rc;
}

void
folder_release(struct folder *f)
{
    for (int i = 0; i < FOLDER_CHAINS; i++)
        while (f->jobs[i])
            drop_job(f, f->jobs[i]->id);
    syncs_release(&f->opened.closed);
}
