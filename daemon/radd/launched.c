/* launched.c - see launched.h */
#include "config.h"

#include "radd/launched.h"

#include "ground/service.h"
#include "net/key/keyfile.h"

#include "base/output.h"

#include <dirent.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define SETTLED_S 60 /* a folder in use is locked when it is so old [s] */

/* --- the key --- */

/* Read the first line of standard input, without its newline; false: no
 * character came. */
static bool
read_line(char *line, size_t size)
{
    struct pollfd in = { .fd = STDIN_FILENO, .events = POLLIN };
    size_t n = 0;

    while (n + 1 < size && poll(&in, 1, LAUNCHED_PATIENCE_MS) > 0 &&
           read(STDIN_FILENO, line + n, 1) == 1 && line[n] != '\n')
        n++;
    line[n] = '\0';
    return n > 0;
}

static int
take_key(struct dial_key *key, const char *line, struct rad_error *err)
{
    struct keyfile f;
    int rc = keyfile_parse(&f, line, strlen(line), err);

    if (rc == 0 && (f.n != 1 || f.v[0].retired))
        rc = rad_fail(err, RAD_ECONFIG, "expected one key");
    if (rc == 0) {
        key_id(&f.v[0], key->id);
        memcpy(key->secret, f.v[0].secret, KEY_SECRET);
        key->expires = f.v[0].expires;
    }
    keyfile_release(&f);
    return rc;
}

int
launched_key(struct dial_key *key, struct rad_error *err)
{
    char *variable = getenv(LAUNCHED_VARIABLE), line[KEY_LINE + 1];
    int rc;

    if (!variable && !read_line(line, sizeof line))
        return rad_fail(err, RAD_ENOINPUT,
                        "no key came, neither in " LAUNCHED_VARIABLE
                        " nor by standard input: what radsubmit --launch "
                        "runs must forward one of them");
    rc = take_key(key, variable ? variable : line, err);
    if (rc < 0)
        rad_error_where(err, variable ? LAUNCHED_VARIABLE : "standard input");
    if (variable) { /* wipe the text: /proc/PID/environ shows it */
        explicit_bzero(variable, strlen(variable));
        unsetenv(LAUNCHED_VARIABLE);
    }
    explicit_bzero(line, sizeof line);
    return rc;
}

/* --- the name --- */

void
launched_name(char *name, size_t size)
{
    char host[64];
    size_t n;

    if (gethostname(host, sizeof host) != 0)
        host[0] = '\0';
    host[sizeof host - 1] = '\0';
    n = strcspn(host, ".");
    if (n > size - 16)
        n = size - 16;
    snprintf(name, size, "%.*s-%ld", key_name_valid(host, n) ? (int)n : 4,
             key_name_valid(host, n) ? host : "host", (long)getpid());
}

/* --- the folder --- */

static const char *
base_folder(void)
{
    const char *tmp = getenv("TMPDIR");

    return tmp && tmp[0] == '/' && strlen(tmp) < 80 ? tmp : "/tmp";
}

/* Remove the folder of a launched worker, unless a process has locked it.  A
 * young folder is left alone: its worker may not have locked it yet. */
static void
sweep_one(const char *path)
{
    struct stat st;
    int lock;

    if (lstat(path, &st) != 0 || !S_ISDIR(st.st_mode) ||
        st.st_uid != geteuid() || time(NULL) - st.st_mtime < SETTLED_S)
        return;
    lock = service_lock_dir(path, NULL);
    if (lock < 0)
        return;
    rad_remove_dir(path);
    close(lock);
}

static void
sweep(const char *base, const char *prefix)
{
    DIR *dir = opendir(base);
    struct dirent *e;
    char path[512];

    while (dir && (e = readdir(dir)) != NULL)
        if (strncmp(e->d_name, prefix, strlen(prefix)) == 0 &&
            snprintf(path, sizeof path, "%s/%s", base, e->d_name) <
                (int)sizeof path)
            sweep_one(path);
    if (dir)
        closedir(dir);
}

int
launched_begin(struct launched *l, struct rad_error *err)
{
    const char *base = base_folder();
    char prefix[40];

    snprintf(prefix, sizeof prefix, "radd-launched-%ld.", (long)geteuid());
    sweep(base, prefix);
    snprintf(l->folder, sizeof l->folder, "%s/%sXXXXXX", base, prefix);
    if (!mkdtemp(l->folder)) {
        l->folder[0] = '\0';
        return rad_fail(err, RAD_ECANTCREAT, "cannot make a folder in '%s': %s",
                        base, strerror(errno));
    }
    return 0;
}

void
launched_end(struct launched *l)
{
    if (l->folder[0])
        rad_remove_dir(l->folder);
}

/* --- the end --- */

bool
launched_over(struct launched *l, uint64_t now_ms, bool connected)
{
    if (connected || l->heard_ms == 0)
        l->heard_ms = now_ms;
    l->welcome |= connected;
    return now_ms - l->heard_ms >= LAUNCHED_PATIENCE_MS;
}
