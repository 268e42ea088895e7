/* paths.c - see paths.h */
#include "config.h"

#include "compile/paths.h"

#include "base/list.h"

#include <limits.h>
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

/* Put the path folder[0..len)/name into path; false: it cannot be read.  An
 * empty folder means the current one. */
static bool
try_folder(const char *folder, size_t len, const char *name,
           char path[PATH_MAX])
{
    int n = snprintf(path, PATH_MAX, "%.*s%s%s", (int)len, folder,
                     len ? "/" : "", name);

    return n >= 0 && n < PATH_MAX && readable(path);
}

/* Look in an entry of RAYPATH, entry[0..len).  A relative one is first taken
 * from each of the scene's folders. */
static bool
try_entry(const struct paths *p, const char *entry, size_t len,
          const char *name, char path[PATH_MAX])
{
    bool here = len == 0 || (len == 1 && entry[0] == '.');
    char folder[PATH_MAX];

    for (int i = 0; i < p->n && entry[0] != '/'; i++) {
        int n = here ? snprintf(folder, sizeof folder, "%s", p->folders[i])
                     : snprintf(folder, sizeof folder, "%s/%.*s", p->folders[i],
                                (int)len, entry);

        if (n >= 0 && n < PATH_MAX && try_folder(folder, (size_t)n, name, path))
            return true;
    }
    return try_folder(entry, len, name, path);
}

/* ~/name, ~user/name */
static bool
try_home(const char *name, char path[PATH_MAX])
{
    size_t n = strcspn(name + 1, "/");
    char user[LOGIN_NAME_MAX];
    const char *home = NULL;

    if (n == 0) {
        home = getenv("HOME");
    } else if (n < sizeof user) {
        const struct passwd *pw;

        memcpy(user, name + 1, n);
        user[n] = '\0';
        pw = getpwnam(user);
        home = pw ? pw->pw_dir : NULL;
    }
    name += 1 + n;
    name += *name == '/';
    return home && try_folder(home, strlen(home), name, path);
}

/* Look in each entry of RAYPATH. */
static bool
try_entries(const struct paths *p, const char *name, char path[PATH_MAX])
{
    for (const char *entry = p->raypath;;) {
        size_t len = strcspn(entry, ":");

        if (try_entry(p, entry, len, name, path))
            return true;
        if (entry[len] == '\0')
            return false;
        entry += len + 1;
    }
}

/* Want of memory is no reason to look further: another file may have the name
 * there. */
char *
paths_find(const struct paths *p, const char *name, struct rad_error *err)
{
    char path[PATH_MAX], *found;
    bool is_there = name[0] == '/'   ? try_folder("", 0, name, path)
                    : name[0] == '~' ? try_home(name, path)
                    : name[0] == '.' ? try_entry(p, "", 0, name, path)
                                     : try_entries(p, name, path);

    if (!is_there) {
        rad_fail(err, RAD_ENOINPUT, "cannot find file '%s'%s", name,
                 !strchr("/~.", name[0]) && !getenv("RAYPATH")
                     ? ": RAYPATH is not set"
                     : "");
        return NULL;
    }
    found = strdup(path);
    if (!found)
        rad_fail_memory(err);
    return found;
}

/* The path of a file of the scene, which is noted as an input; to be freed. */
static char *
find_input(struct paths *p, const char *name, struct rad_error *err)
{
    char *path = paths_find(p, name, err);

    if (path && inputs_add(p->inputs, "a file of the scene", path, err) < 0) {
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
