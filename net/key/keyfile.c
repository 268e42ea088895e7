/* keyfile.c - see keyfile.h
 *
 * The file's text is kept beside the parsed keys, so that a change leaves all
 * comments as they are: a new key is a line at the end, and a retired key's
 * line is replaced. */
#include "config.h"

#include "net/key/keyfile.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* --- reading --- */

void
keyfile_init(struct keyfile *f)
{
    *f = (struct keyfile){ 0 };
}

static void
free_wiped(void *p, size_t n)
{
    if (p)
        explicit_bzero(p, n);
    free(p);
}

void
keyfile_release(struct keyfile *f)
{
    free_wiped(f->v, f->n * sizeof *f->v);
    free_wiped(f->text, f->len);
    keyfile_init(f);
}

static bool
same_id(const struct key *a, const struct key *b)
{
    return a->role == b->role && a->number == b->number &&
           strcmp(a->name, b->name) == 0;
}

/* Make room for one more key.  The old array is wiped. */
static bool
grow(struct keyfile *f)
{
    struct key *v;

    if (f->n & (f->n - 1)) /* it is full when n is a power of two */
        return true;
    v = calloc(f->n ? 2 * f->n : 1, sizeof *v);
    if (!v)
        return false;
    if (f->n)
        memcpy(v, f->v, f->n * sizeof *v);
    free_wiped(f->v, f->n * sizeof *v);
    f->v = v;
    return true;
}

static int
take_line(struct keyfile *f, size_t at, size_t len, struct rad_error *err)
{
    const char *line = f->text + at, *why;
    struct key k;
    size_t blank = 0;

    while (blank < len && (line[blank] == ' ' || line[blank] == '\t'))
        blank++;
    if (blank == len || line[blank] == '#')
        return 0;
    if (len > KEY_LINE)
        return rad_fail(err, RAD_ECONFIG, "line longer than %d bytes",
                        KEY_LINE);
    why = key_parse(line, len, &k);
    for (size_t i = 0; !why && i < f->n; i++)
        if (same_id(&f->v[i], &k))
            why = "this key is there already";
    if (!why && f->n == KEY_MOST)
        why = "too many keys";
    if (why) {
        explicit_bzero(&k, sizeof k);
        return rad_fail(err, RAD_ECONFIG, "%s", why);
    }
    if (!grow(f))
        return rad_fail_memory(err);
    k.at = at;
    k.len = len;
    f->v[f->n++] = k;
    explicit_bzero(&k, sizeof k);
    return 0;
}

int
keyfile_parse(struct keyfile *f, const char *text, size_t len,
              struct rad_error *err)
{
    unsigned number = 0;

    keyfile_init(f);
    if (len > KEY_MAX_FILE)
        return rad_fail(err, RAD_ECONFIG, "longer than %u bytes", KEY_MAX_FILE);
    f->text = malloc(len + 1);
    if (!f->text)
        return rad_fail_memory(err);
    if (len)
        memcpy(f->text, text, len);
    f->text[len] = '\0';
    f->len = len;
    for (size_t at = 0; at < len;) {
        const char *end = memchr(f->text + at, '\n', len - at);
        size_t n = end ? (size_t)(end - f->text) - at : len - at;
        int rc;

        number++;
        rc = take_line(f, at, n, err);
        if (rc < 0) {
            rad_error_where(err, "line %u", number);
            keyfile_release(f);
            return rc;
        }
        at += n + 1;
    }
    return 0;
}

/* Is the file only its owner's to read, and is the owner a user whom we trust?
 */
static int
check_mode(const struct stat *st, const char *path, struct rad_error *err)
{
    const char *credentials = getenv("CREDENTIALS_DIRECTORY");
    mode_t shared = st->st_mode & 077;
    size_t n = credentials ? strlen(credentials) : 0;

    if (!S_ISREG(st->st_mode))
        return rad_fail(err, RAD_ENOINPUT, "'%s' is no file", path);
    if (st->st_uid != geteuid() && st->st_uid != 0)
        return rad_fail(err, RAD_EPERM, "key file '%s' is another user's",
                        path);
    if (n > 0 && strncmp(path, credentials, n) == 0 && path[n] == '/' &&
        st->st_uid == 0 && st->st_gid == 0)
        shared &= ~(mode_t)040;
    if (shared)
        return rad_fail(err, RAD_EPERM,
                        "key file '%s' is open to others (mode %04o): use "
                        "chmod 600",
                        path, (unsigned)(st->st_mode & 07777));
    return 0;
}

/* Read an open file; the caller wipes and frees the bytes. */
static int
read_all(int fd, const char *path, char **text, size_t *len,
         struct rad_error *err)
{
    char *p = malloc(KEY_MAX_FILE + 1);
    size_t n = 0;
    ssize_t got = 1;

    *text = NULL;
    if (!p)
        return rad_fail_memory(err);
    while (n <= KEY_MAX_FILE &&
           (got = read(fd, p + n, KEY_MAX_FILE + 1 - n)) > 0)
        n += (size_t)got;
    if (got < 0) {
        free_wiped(p, n);
        return rad_fail(err, RAD_EIO, "cannot read '%s': %s", path,
                        strerror(errno));
    }
    *text = p;
    *len = n;
    return 0;
}

int
keyfile_load_fd(struct keyfile *f, int fd, const char *path,
                struct rad_error *err)
{
    struct stat st;
    char *text;
    size_t len = 0;
    int rc;

    keyfile_init(f);
    if (fstat(fd, &st) < 0)
        return rad_fail(err, RAD_EIO, "'%s': %s", path, strerror(errno));
    if ((rc = check_mode(&st, path, err)) < 0 ||
        (rc = read_all(fd, path, &text, &len, err)) < 0)
        return rc;
    rc = keyfile_parse(f, text, len, err);
    free_wiped(text, len);
    if (rc < 0 && err) { /* "line 3" becomes "FILE:3" */
        unsigned line;

        if (sscanf(err->where, "line %u", &line) == 1)
            snprintf(err->where, sizeof err->where, "%.200s:%u", path, line);
        else
            rad_error_where(err, "%s", path);
    }
    return rc;
}

int
keyfile_load(struct keyfile *f, const char *path, struct rad_error *err)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK), rc;

    keyfile_init(f);
    if (fd < 0)
        return rad_fail(err, errno == EACCES ? RAD_EPERM : RAD_ENOINPUT,
                        "cannot open key file '%s': %s", path, strerror(errno));
    rc = keyfile_load_fd(f, fd, path, err);
    close(fd);
    return rc;
}

/* --- looking keys up --- */

const struct key *
keyfile_find(const struct keyfile *f, const char *id)
{
    struct key k;

    if (!key_id_parse(id, &k) || k.number == 0)
        return NULL;
    for (size_t i = 0; i < f->n; i++)
        if (same_id(&f->v[i], &k))
            return &f->v[i];
    return NULL;
}

const struct key *
keyfile_best(const struct keyfile *f, enum msg_role role, int64_t now)
{
    const struct key *best = NULL;

    for (size_t i = 0; i < f->n; i++)
        if (f->v[i].role == role && key_state(&f->v[i], now) == KEY_VALID &&
            (!best || f->v[i].number > best->number))
            best = &f->v[i];
    return best;
}

static const struct key *
choice(const struct keyfile *f, enum msg_role role, int64_t now)
{
    const struct key *k = keyfile_best(f, role, now);

    if (!k && role == MSG_ROLE_USER)
        k = keyfile_best(f, MSG_ROLE_ADMIN, now);
    for (size_t i = f->n; !k && i-- > 0;)
        if (f->v[i].role == role && !f->v[i].retired)
            k = &f->v[i];
    for (size_t i = f->n; !k && i-- > 0;)
        if (!f->v[i].retired)
            k = &f->v[i];
    return k;
}

int
keyfile_choose(const char *path, enum msg_role role, char id[KEY_ID],
               uint8_t secret[KEY_SECRET], int64_t *expires,
               struct rad_error *err)
{
    struct keyfile f;
    const struct key *k;
    int rc = keyfile_load(&f, path, err);

    if (rc < 0)
        return rc;
    k = choice(&f, role, (int64_t)time(NULL));
    if (k) {
        key_id(k, id);
        memcpy(secret, k->secret, KEY_SECRET);
        *expires = k->expires;
    } else {
        rc = rad_fail(err, RAD_EPERM, "there is no key in '%s'", path);
    }
    keyfile_release(&f);
    return rc;
}

/* --- changing it --- */

/* Replace `old` bytes at `at` by the n bytes of `with`, and parse the whole
 * again. */
static int
replace_part(struct keyfile *f, size_t at, size_t old, const char *with,
             size_t n, struct rad_error *err)
{
    size_t len = f->len - old + n;
    char *text = malloc(len + 1);
    struct keyfile next;
    int rc;

    if (!text)
        return rad_fail_memory(err);
    if (at)
        memcpy(text, f->text, at);
    memcpy(text + at, with, n);
    if (f->len > at + old)
        memcpy(text + at + n, f->text + at + old, f->len - at - old);
    rc = keyfile_parse(&next, text, len, err);
    free_wiped(text, len);
    if (rc < 0)
        return rc;
    keyfile_release(f);
    *f = next;
    return 0;
}

static bool
random_bytes(uint8_t *p, size_t n)
{
    while (n > 0) {
        ssize_t got = getrandom(p, n, 0);

        if (got <= 0 && errno != EINTR)
            return false;
        if (got > 0) {
            p += got;
            n -= (size_t)got;
        }
    }
    return true;
}

/* The highest number that a name's keys ever had. */
static uint32_t
last_number(const struct keyfile *f, const struct key *of)
{
    uint32_t last = 0;

    for (size_t i = 0; i < f->n; i++)
        if (f->v[i].role == of->role && strcmp(f->v[i].name, of->name) == 0 &&
            f->v[i].number > last)
            last = f->v[i].number;
    return last;
}

int
keyfile_add(struct keyfile *f, const char *name, int64_t expires,
            struct rad_error *err)
{
    bool open_end = f->len > 0 && f->text[f->len - 1] != '\n';
    char line[KEY_LINE + 3];
    struct key k;
    int rc = key_name_parse(name, &k, err);

    if (rc < 0)
        return rc;
    k.number = last_number(f, &k) + 1;
    k.expires = expires;
    if (f->n >= KEY_MOST)
        return rad_fail(err, RAD_ECONFIG, "a file holds at most %d keys",
                        KEY_MOST);
    if (k.number > KEY_MAX_NUMBER)
        return rad_fail(err, RAD_ECONFIG, "'%s' has had k%d, the last", name,
                        KEY_MAX_NUMBER);
    if (!random_bytes(k.secret, sizeof k.secret))
        return rad_fail(err, RAD_EINTERNAL, "no random bytes: %s",
                        strerror(errno));
    line[0] = '\n';
    key_format(&k, line + open_end);
    strcat(line, "\n");
    rc = replace_part(f, f->len, 0, line, strlen(line), err);
    explicit_bzero(&k, sizeof k);
    explicit_bzero(line, sizeof line);
    return rc;
}

int
keyfile_retire(struct keyfile *f, const char *name, struct rad_error *err)
{
    char line[KEY_LINE + 1];
    struct key which;
    int found = 0, changed = 0, rc = key_which_parse(name, &which, err);

    if (rc < 0)
        return rc;
    for (size_t i = 0; i < f->n; i++) {
        struct key *k = &f->v[i];

        if (k->role != which.role || strcmp(k->name, which.name) != 0 ||
            (which.number != 0 && k->number != which.number))
            continue;
        found++;
        if (k->retired)
            continue;
        k->retired = true;
        key_format(k, line);
        if ((rc = replace_part(f, k->at, k->len, line, strlen(line), err)) < 0)
            return rc;
        changed++;
    }
    return found ? changed
                 : rad_fail(err, RAD_ENOINPUT, "there is no key '%s'", name);
}
