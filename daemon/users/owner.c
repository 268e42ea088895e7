/* owner.c - see owner.h */
#include "config.h"

#include "users/owner.h"

#include "ground/conf.h"
#include "net/conn.h"
#include "net/log.h"

#include <errno.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define KNOWN    256   /* logins that are remembered, by the user's number */
#define FRESH_MS 60000 /* a login serves for so long after it was looked up */
#define MOST     64    /* most streams that wait for a login */

struct known {
    bool set;
    long uid;
    uint64_t ms; /* when the login was looked up */
    char login[OWNER_TEXT];
};

/* A stream that waits for its user's login.  While a login is looked up it is
 * the login of the first stream's user. */
struct waiting {
    struct waiting *next;
    uv_stream_t *stream;
    long uid;
};

struct owners {
    uv_loop_t *loop;
    owners_fn *fn;
    void *arg;
    char map[CONF_TEXT];
    char root[OWNER_TEXT], self[OWNER_TEXT]; /* logins of user 0 and of ours */
    struct known known[KNOWN];
    struct waiting *first, **last;
    unsigned nwaiting;
    bool looking; /* work is under way: it looks up the login of uid */
    uv_work_t work;
    long uid;               /* [fixed] while looking */
    char login[OWNER_TEXT]; /* [pool] while looking, else [loop] */
    bool found;             /* as login; false: the database of users failed */
};

/* --- the database of users --- */

/* Can this result of getpwuid_r() mean that no user has the number?  See
 * getpwuid(3). */
static bool
is_nobody(int rc)
{
    return rc == 0 || rc == ENOENT || rc == ESRCH || rc == EBADF || rc == EPERM;
}

/* Look up the login of user uid; "uid:1002" if there is none.  False: the
 * database of users fails. */
static bool
login_of(long uid, char login[OWNER_TEXT])
{
    long most = sysconf(_SC_GETPW_R_SIZE_MAX);
    size_t size = most > 16384 ? (size_t)most : 16384;
    char *buf = malloc(size);
    struct passwd pw, *found = NULL;
    int rc = buf ? getpwuid_r((uid_t)uid, &pw, buf, size, &found) : ENOMEM;

    if (found && found->pw_name[0] && strlen(found->pw_name) < OWNER_TEXT)
        snprintf(login, OWNER_TEXT, "%s", found->pw_name);
    else
        snprintf(login, OWNER_TEXT, "uid:%ld", uid);
    free(buf);
    return found || is_nobody(rc);
}

/* --- lookups --- */

static struct known *
slot_of(struct owners *o, long uid)
{
    return &o->known[(unsigned long)uid % KNOWN];
}

static void
look(uv_work_t *work)
{
    struct owners *o = work->data;

    o->found = login_of(o->uid, o->login);
}

static struct waiting *
take_first(struct owners *o)
{
    struct waiting *w = o->first;

    o->first = w->next;
    if (!o->first)
        o->last = &o->first;
    o->nwaiting--;
    return w;
}

static const char *
fresh(struct owners *o, long uid)
{
    const struct known *k = slot_of(o, uid);
    bool is = k->set && k->uid == uid && uv_now(o->loop) - k->ms < FRESH_MS;

    return is ? k->login : NULL;
}

static void looked(uv_work_t *work, int status);

/* Hand on the first streams as long as their logins are known, then look up the
 * login of the next stream's user. */
static void
go_on(struct owners *o)
{
    const char *login;

    while (o->first && (login = fresh(o, o->first->uid)) != NULL) {
        struct waiting *w = take_first(o);

        o->fn(o->arg, w->stream, login);
        free(w);
    }
    if (o->looking || !o->first)
        return;
    o->uid = o->first->uid;
    o->work.data = o;
    o->looking = uv_queue_work(o->loop, &o->work, look, looked) == 0;
}

/* Remember the login that was looked up, and return it.  If the look-up failed:
 * the login that was known before, or NULL. */
static const char *
remember(struct owners *o)
{
    struct known *k = slot_of(o, o->uid);

    if (!o->found) {
        log_warn("login not found uid=%ld why=the database of users fails",
                 o->uid);
        return k->set && k->uid == o->uid ? k->login : NULL;
    }
    *k = (struct known){ true, o->uid, uv_now(o->loop), "" };
    memcpy(k->login, o->login, OWNER_TEXT);
    return k->login;
}

static void
looked(uv_work_t *work, int status)
{
    struct owners *o = work->data;
    struct waiting *w;
    const char *login;

    (void)status;
    o->looking = false;
    if (!o->first) /* owners_close() was called */
        return;
    w = take_first(o);
    login = remember(o);
    o->fn(o->arg, w->stream, login);
    free(w);
    go_on(o);
}

void
owners_local(struct owners *o, uv_stream_t *stream)
{
    long uid = conn_stream_uid(stream);
    const char *login = fresh(o, uid);
    struct waiting *w;

    if (login) {
        o->fn(o->arg, stream, login);
        return;
    }
    w = o->nwaiting < MOST ? calloc(1, sizeof *w) : NULL;
    if (!w) {
        o->fn(o->arg, stream, NULL);
        return;
    }
    w->stream = stream;
    w->uid = uid;
    *o->last = w;
    o->last = &w->next;
    o->nwaiting++;
    if (!o->looking)
        go_on(o);
}

/* --- the map --- */

/* A "KEY=LOGIN" of a map, which next_entry() reads from p on.  That returns the
 * place behind the entry; NULL: the map has no more. */
struct entry {
    const char *key, *login;
    size_t nkey, nlogin;
};

static const char *
next_entry(const char *p, struct entry *e)
{
    p += strspn(p, " \t,");
    if (*p == '\0')
        return NULL;
    e->key = p;
    e->nkey = strcspn(p, "=, \t");
    p += e->nkey;
    e->login = p + (*p == '=');
    e->nlogin = *p == '=' ? strcspn(e->login, ", \t") : 0;
    return e->login + e->nlogin;
}

int
owners_check_map(const char *map, struct rad_error *err)
{
    struct entry e;

    for (const char *p = next_entry(map, &e); p; p = next_entry(p, &e)) {
        if (e.nlogin == 0 || !key_name_valid(e.key, e.nkey))
            return rad_fail(err, RAD_EUSAGE, "'%.*s': expected KEY=LOGIN",
                            (int)(p - e.key), e.key);
        if (e.nlogin >= OWNER_TEXT || memchr(e.login, ':', e.nlogin) ||
            memchr(e.login, '=', e.nlogin))
            return rad_fail(err, RAD_EUSAGE, "'%.*s' is no login",
                            (int)e.nlogin, e.login);
    }
    return 0;
}

void
owners_set_map(struct owners *o, const char *map)
{
    snprintf(o->map, sizeof o->map, "%s", map);
}

/* Set login to the login that the map has for a key's name, or to that name if
 * it is not in the map.  False: the map says that the key has no login. */
static bool
mapped(const struct owners *o, const char *name, char login[OWNER_TEXT])
{
    struct entry e;

    snprintf(login, OWNER_TEXT, "%s", name);
    for (const char *p = next_entry(o->map, &e); p; p = next_entry(p, &e))
        if (e.nkey == strlen(name) && memcmp(e.key, name, e.nkey) == 0)
            snprintf(login, OWNER_TEXT, "%.*s", (int)e.nlogin, e.login);
    return strcmp(login, "-") != 0;
}

void
owners_of_key(const struct owners *o, const struct key *k,
              char owner[OWNER_TEXT])
{
    bool has_login = mapped(o, k->name, owner);
    bool over = strcmp(owner, o->root) == 0 || strcmp(owner, o->self) == 0;

    if (!has_login || (over && k->role != MSG_ROLE_ADMIN) ||
        k->role == MSG_ROLE_OBSERVER) /* an observer owns no jobs */
        /* the end of a very long name is cut; no login is so long, for logins
         * have at most 32 characters */
        snprintf(owner, OWNER_TEXT, "%s:%.*s", key_role_name(k->role),
                 (int)(OWNER_TEXT - 8), k->name);
}

void
owners_of_saved(const char *saved, char owner[OWNER_TEXT])
{
    char *end;
    unsigned long uid;

    snprintf(owner, OWNER_TEXT, "%s", saved);
    if (strncmp(saved, "uid:", 4) != 0 || saved[4] < '0' || saved[4] > '9')
        return;
    uid = strtoul(saved + 4, &end, 10);
    if (*end != '\0' || uid > UINT32_MAX || !login_of((long)uid, owner))
        snprintf(owner, OWNER_TEXT, "%s", saved);
}

/* --- begin and end --- */

struct owners *
owners_new(uv_loop_t *loop, owners_fn *fn, void *arg)
{
    struct owners *o = calloc(1, sizeof *o);

    if (!o)
        return NULL;
    o->loop = loop;
    o->fn = fn;
    o->arg = arg;
    o->last = &o->first;
    login_of(0, o->root);
    login_of((long)geteuid(), o->self);
    return o;
}

void
owners_close(struct owners *o)
{
    while (o && o->first) {
        struct waiting *w = take_first(o);

        conn_stream_close(w->stream);
        free(w);
    }
}

void
owners_free(struct owners *o)
{
    free(o);
}
