/* paths.c - see paths.h */
#include "config.h"

#include "compile/paths.h"

#include "base/list.h"

#include <pwd.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEFAULT_RAYPATH ":/usr/local/lib/ray"

int
paths_init(struct paths *p, struct rad_error *err)
{
    const char *path = getenv("RAYPATH");

    memset(p, 0, sizeof *p);
    p->raypath = strdup(path ? path : DEFAULT_RAYPATH);
    return p->raypath ? 0 : rad_fail_memory(err);
}

void
paths_release(struct paths *p)
{
    for (int i = 0; i < p->n; i++)
        free(p->folders[i]);
    free(p->folders);
    inputs_release(&p->inputs);
    free(p->raypath);
    memset(p, 0, sizeof *p);
}

char *
paths_folder_of(const char *file)
{
    const char *slash = strrchr(file, '/');

    if (!slash)
        return strdup(".");
    return strndup(file, slash == file ? 1 : (size_t)(slash - file));
}

int
paths_add_file(struct paths *p, const char *scene_file, struct rad_error *err)
{
    char *folder = paths_folder_of(scene_file);
    bool known, grown = false;

    if (!folder)
        return rad_fail_memory(err);
    known = strcmp(folder, ".") == 0;
    for (int i = 0; i < p->n; i++)
        known |= strcmp(p->folders[i], folder) == 0;
    if (!known)
        grown = rad_list_grow(&p->folders, (size_t)p->n, sizeof *p->folders);
    if (grown)
        p->folders[p->n++] = folder;
    else
        free(folder);
    return known || grown ? 0 : rad_fail_memory(err);
}

/* Is it a regular file that we may read?  A pipe or a device may have no end,
 * and gives its bytes only once. */
static bool
readable(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISREG(st.st_mode) &&
           access(path, R_OK) == 0;
}

/* The path folder[0..len)/name if it can be read, malloc'd; else NULL.  An
 * empty folder means the current one. */
static char *
try_folder(const char *folder, size_t len, const char *name)
{
    char *path;
    int n = len ? asprintf(&path, "%.*s/%s", (int)len, folder, name)
                : asprintf(&path, "%s", name);

    if (n < 0)
        return NULL;
    if (readable(path))
        return path;
    free(path);
    return NULL;
}

/* Look in an entry of RAYPATH, entry[0..len).  A relative one is first taken
 * from each of the scene's folders. */
static char *
try_entry(const struct paths *p, const char *entry, size_t len,
          const char *name)
{
    bool here = len == 0 || (len == 1 && entry[0] == '.');
    char *path = NULL, *folder;

    for (int i = 0; i < p->n && !path && entry[0] != '/'; i++) {
        int n =
            here ? asprintf(&folder, "%s", p->folders[i])
                 : asprintf(&folder, "%s/%.*s", p->folders[i], (int)len, entry);

        if (n < 0)
            return NULL;
        path = try_folder(folder, (size_t)n, name);
        free(folder);
    }
    return path ? path : try_folder(entry, len, name);
}

/* ~/name, ~user/name */
static char *
try_home(const char *name)
{
    size_t n = strcspn(name + 1, "/");
    char *user = strndup(name + 1, n);
    const char *home = NULL;

    if (!user)
        return NULL;
    if (n == 0) {
        home = getenv("HOME");
    } else {
        const struct passwd *pw = getpwnam(user);

        home = pw ? pw->pw_dir : NULL;
    }
    free(user);
    name += 1 + n;
    name += *name == '/';
    return home ? try_folder(home, strlen(home), name) : NULL;
}

char *
paths_find(const struct paths *p, const char *name, struct rad_error *err)
{
    const char *entry = p->raypath;
    char *path = NULL;

    if (name[0] == '/')
        path = try_folder("", 0, name);
    else if (name[0] == '~')
        path = try_home(name);
    else if (name[0] == '.')
        path = try_entry(p, "", 0, name);
    else
        for (;;) {
            size_t len = strcspn(entry, ":");

            path = try_entry(p, entry, len, name);
            if (path || entry[len] == '\0')
                break;
            entry += len + 1;
        }
    if (!path)
        rad_fail(err, RAD_ENOINPUT, "cannot find file '%s'", name);
    return path;
}

/* The path of a file of the scene, which is noted as an input; to be freed. */
static char *
find_input(struct paths *p, const char *name, struct rad_error *err)
{
    char *path = paths_find(p, name, err);

    if (path && inputs_add(&p->inputs, "a file of the scene", path, err) < 0) {
        free(path);
        return NULL;
    }
    return path;
}

static unsigned char *
read_file(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    char *path = find_input(arg, name, err);
    unsigned char *bytes =
        path ? rad_file_read(path, PATHS_MAX_FILE, len, err) : NULL;

    free(path);
    return bytes;
}

static int
open_file(void *arg, const char *name, struct rad_error *err)
{
    char *path = find_input(arg, name, err);
    struct stat st;
    int fd;

    if (!path)
        return err->code;
    if (stat(path, &st) == 0 && st.st_size > (off_t)PATHS_MAX_FILE)
        fd = rad_fail(err, RAD_EDATA, "'%s' is larger than %zu bytes", path,
                      PATHS_MAX_FILE);
    else
        fd = rad_file_open(path, err);
    free(path);
    return fd;
}

struct rad_files
paths_files(struct paths *p)
{
    struct rad_files files = { read_file, p, open_file };

    return files;
}
