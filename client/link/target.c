/* target.c - see target.h */
#include "config.h"

#include "link/target.h"

#include "ground/service.h"
#include "net/inifile.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* radcoord's default: radcoord.conf(5) */
#define DEFAULT_SOCKET "/run/radd/radcoord.sock"

enum { LONGEST = sizeof((struct target *)0)->text };

void
target_complete(char *to, size_t size, const char *text, const char *port)
{
    const char *bracket = strrchr(text, ']');
    bool has = strchr(bracket ? bracket : text, ':') != NULL;

    snprintf(to, size, "%s%s%s", text, has ? "" : ":", has ? "" : port);
}

int
target_parse(struct target *a, const char *text, struct rad_error *err)
{
    char whole[sizeof a->text + sizeof ":" RADCOORD_PORT];

    memset(a, 0, sizeof *a);
    assert(strlen(text) < sizeof a->text);
    strcpy(a->text, text);
    if (strchr(text, '/')) {
        a->local = true;
        if (strlen(text) >= sizeof a->path)
            return rad_fail(err, RAD_EUSAGE,
                            "socket path '%s' is longer than %zu bytes", text,
                            sizeof a->path - 1);
        strcpy(a->path, text);
        return 0;
    }
    if (address_check_brackets(text, err) < 0)
        return RAD_EUSAGE;
    target_complete(whole, sizeof whole, text, RADCOORD_PORT);
    if (address_split(whole, a->host, a->port, &a->local, NULL) < 0 ||
        atoi(a->port) == 0)
        return rad_fail(err, RAD_EUSAGE,
                        "bad coordinator address '%s': expected HOST:PORT or "
                        "a socket's path",
                        text);
    return 0;
}

/* What the configuration names. */
struct found {
    char address[LONGEST];
    char key[LONGEST];
    bool has_address, has_key; /* in the file that is being read */
};

static int
take_pair(void *arg, const char *section, const char *name, const char *value,
          struct rad_error *err)
{
    struct found *f = arg;
    bool ours = section[0] == '\0' || strcmp(section, "radsubmit") == 0;
    char *to = ours && strcmp(name, "coordinator") == 0 ? f->address
               : ours && strcmp(name, "key") == 0       ? f->key
                                                        : NULL;
    bool *has = to == f->address ? &f->has_address : &f->has_key;
    struct target parsed;

    if (!to)
        return rad_fail(err, RAD_ECONFIG, "unknown key '%s'", name);
    if (*has)
        return rad_fail(err, RAD_ECONFIG, "'%s' is there twice", name);
    *has = true;
    if (strlen(value) >= LONGEST)
        return rad_fail(err, RAD_ECONFIG, "'%s': longer than %d bytes", name,
                        LONGEST - 1);
    if (to == f->address && value[0] && target_parse(&parsed, value, err) < 0)
        return err->code = RAD_ECONFIG;
    strcpy(to, value);
    return 0;
}

/* Read a file and take from it what is not known yet.  A missing file names
 * nothing, nor does another user's home, as after sudo. */
static int
read_file(struct found *known, const char *path, struct rad_error *err)
{
    struct found f = { .address = "" };
    FILE *in = fopen(path, "re");
    int rc;

    if (!in) {
        int why = errno;

        if (why == ENOENT || why == ENOTDIR ||
            (why == EACCES && access(path, F_OK) < 0))
            return 0;
        return rad_fail(err, RAD_ECONFIG, "cannot open '%s': %s", path,
                        strerror(why));
    }
    rc = inifile_read(in, path, take_pair, &f, err);
    fclose(in);
    if (rc < 0)
        return rc;
    if (!known->address[0])
        memcpy(known->address, f.address, LONGEST);
    if (!known->key[0])
        memcpy(known->key, f.key, LONGEST);
    return 0;
}

/* The path of the user's file; false: there is no home folder. */
static bool
user_file(char *path, size_t size)
{
    const char *base = getenv("XDG_CONFIG_HOME"), *below = "";
    int n;

    if (!base || base[0] != '/') {
        base = getenv("HOME");
        below = "/.config";
    }
    if (!base || base[0] == '\0')
        return false;
    n = snprintf(path, size, "%s%s/radd/radsubmit.conf", base, below);
    return n > 0 && (size_t)n < size;
}

#define SYSTEM_FILE RADD_SYSCONFDIR "/radd/radsubmit.conf"

int
target_note(struct inputs *in, struct rad_error *err)
{
    char path[4096];
    int rc = 0;

    if (user_file(path, sizeof path))
        rc = inputs_add(in, "the configuration", path, err);
    return rc == 0 ? inputs_add(in, "the configuration", SYSTEM_FILE, err) : rc;
}

/* Take the option's value, if it is given, else the variable's. */
static int
take_named(char to[LONGEST], const char *given, const char *variable,
           struct rad_error *err)
{
    const char *value = given ? given : getenv(variable);

    if (value && strlen(value) >= LONGEST)
        return rad_fail(err, RAD_EUSAGE,
                        "coordinator's address or key file is too long");
    strcpy(to, value ? value : "");
    return 0;
}

int
target_find(struct target *a, const char *given, const char *key,
            struct rad_error *err)
{
    struct found f = { .address = "" };
    char path[4096];
    int rc;

    if ((rc = take_named(f.address, given, "RADD_COORDINATOR", err)) < 0 ||
        (rc = take_named(f.key, key, "RADD_KEY", err)) < 0)
        return rc;
    if (!f.address[0] || (!f.key[0] && !strchr(f.address, '/'))) {
        if (user_file(path, sizeof path))
            rc = read_file(&f, path, err);
        if (rc == 0)
            rc = read_file(&f, SYSTEM_FILE, err);
    }
    if (rc < 0 || (!f.address[0] && !given))
        return rc;
    rc = target_parse(a, f.address, err);
    if (rc < 0)
        return rc;
    memcpy(a->key, f.key, sizeof a->key);
    return 1;
}

void
target_default(struct target *a)
{
    target_parse(a, DEFAULT_SOCKET, NULL);
}
