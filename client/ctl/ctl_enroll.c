/* ctl_enroll.c - radctl enroll: make for each worker a folder with the files
 * for its host
 *
 * A key is made for a worker only if it has none that the coordinator would
 * accept, neither in its folder nor in the key file that --keys names.  So the
 * same command again gives the same key. */
#include "config.h"

#include "ctl/ctl.h"
#include "ctl/row.h"

#include "base/output.h"
#include "common/table.h"
#include "common/tell.h"
#include "net/key/keyorder.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define SETTINGS RADD_SYSCONFDIR "/radd"

struct enroll {
    struct ctl *c;
    json_t *keys; /* as `key list` gives them */
    json_t *done; /* what is printed at the end */
};

/* --- existing keys --- */

/* Give an order about keys, to the file or to the coordinator; *root: the
 * answer. */
static int
order(struct ctl *c, enum msg_key_order what, const char *name, json_t **root)
{
    struct key_order o = { .what = what, .name = name };
    struct msg m = { .type = MSG_KEY };
    const struct msg *answer;
    char *text;
    int rc;

    *root = NULL;
    if (c->keys) {
        rc = key_order_run(c->keys, &o, (int64_t)time(NULL), &text, c->err);
        if (rc < 0)
            return rc;
        *root = json_loads(text, 0, NULL);
        explicit_bzero(text, strlen(text));
        free(text);
    } else {
        m.key = (struct msg_key){ (uint8_t)what, name ? name : "", 0 };
        if ((rc = ctl_ask(c, &m, &answer)) < 0)
            return rc;
        *root = json_loadb((const char *)answer->answer.text,
                           answer->answer.len, 0, NULL);
    }
    return *root ? 0
                 : rad_fail(c->err, RAD_EPROTO,
                            "the answer about keys is no "
                            "JSON");
}

/* Get the list of keys; a key file that does not exist has none. */
static int
list_keys(struct enroll *e)
{
    struct stat st;

    if (!e->c->keys || stat(e->c->keys, &st) == 0)
        return order(e->c, MSG_KEY_LIST, NULL, &e->keys);
    e->keys = json_array();
    return 0;
}

/* Would the coordinator accept the worker's key of that id, or (NULL) any key
 * of the worker's? */
static bool
is_valid(const struct enroll *e, const char *worker, const char *id)
{
    const json_t *k;
    size_t i;

    json_array_foreach(e->keys, i, k)
    {
        if (strcmp(row_text(k, "role"), "worker") == 0 &&
            strcmp(row_text(k, "name"), worker) == 0 &&
            strcmp(row_text(k, "state"), "valid") == 0 &&
            (!id || strcmp(row_text(k, "key"), id) == 0))
            return true;
    }
    return false;
}

/* The line and id of the worker's best key in a key file; false: it has none.
 */
static bool
key_in_file(const char *path, const char *worker, char line[KEY_LINE + 1],
            char id[KEY_ID])
{
    int64_t now = (int64_t)time(NULL);
    const struct key *best = NULL;
    struct keyfile f;

    if (keyfile_load(&f, path, NULL) < 0)
        return false;
    for (size_t i = 0; i < f.n; i++)
        if (f.v[i].role == MSG_ROLE_WORKER &&
            strcmp(f.v[i].name, worker) == 0 &&
            key_state(&f.v[i], now) == KEY_VALID &&
            (!best || f.v[i].number > best->number))
            best = &f.v[i];
    if (best) {
        key_format(best, line);
        key_id(best, id);
    }
    keyfile_release(&f);
    return best != NULL;
}

static int
add_key(struct enroll *e, const char *worker, char line[KEY_LINE + 1],
        char id[KEY_ID])
{
    char name[MSG_MAX_NAME + 16];
    const char *made, *is;
    json_t *root;
    int rc;

    snprintf(name, sizeof name, "worker:%s", worker);
    if ((rc = order(e->c, MSG_KEY_ADD, name, &root)) < 0)
        return rc;
    made = json_string_value(json_object_get(root, "line"));
    is = json_string_value(json_object_get(root, "key"));
    if (made && is && strlen(made) <= KEY_LINE && strlen(is) < KEY_ID) {
        strcpy(line, made);
        strcpy(id, is);
    } else {
        rc = rad_fail(e->c->err, RAD_EPROTO, "the answer holds no key");
    }
    json_decref(root);
    return rc;
}

/* The line and id of the worker's key; *made: it is new. */
static int
find_key(struct enroll *e, const char *worker, const char *path,
         char line[KEY_LINE + 1], char id[KEY_ID], bool *made)
{
    const char *keys = e->c->keys;

    *made = false;
    if (keys && key_in_file(keys, worker, line, id))
        return 0;
    if (!keys && key_in_file(path, worker, line, id) && is_valid(e, worker, id))
        return 0;
    if (!keys && is_valid(e, worker, NULL))
        return rad_fail(e->c->err, RAD_ECANTCREAT,
                        "worker %s has a key, but not in '%.60s': retire it "
                        "first (radctl key retire), or use --keys",
                        worker, path);
    *made = true;
    return add_key(e, worker, line, id);
}

/* --- files --- */

/* Write a file with the mode that the mask leaves, whatever the user's umask.
 */
static int
write_file(struct ctl *c, const char *path, mode_t mask, const char *text)
{
    mode_t before = umask(mask);
    int rc = rad_output_write(path, text, strlen(text), true, c->err);

    umask(before);
    return rc;
}

/* The settings in radd.conf, the same for all hosts. */
static void
make_settings(const struct ctl *c, char *text, size_t size)
{
    bool v6 = strchr(c->to.host, ':') != NULL;

    snprintf(text, size,
             "# made by radctl enroll; see radd.conf(5)\n"
             "coordinator = %s%s%s:%s\n"
             "listen = *:7421\n",
             v6 ? "[" : "", c->to.host, v6 ? "]" : "", c->to.port);
}

static int
enroll_one(struct enroll *e, const char *worker)
{
    struct ctl *c = e->c;
    char folder[PATH_MAX - 16], path[PATH_MAX], text[700];
    char line[KEY_LINE + 2], id[KEY_ID];
    bool made;
    int rc;

    if (snprintf(folder, sizeof folder, "%s/%s", c->folder, worker) >=
        (int)sizeof folder)
        return rad_fail(c->err, RAD_ECANTCREAT, "path too long: '%.60s...'",
                        c->folder);
    snprintf(path, sizeof path, "%s/key", folder);
    if ((rc = rad_make_dir(folder, 0700, c->err)) < 0 ||
        (rc = find_key(e, worker, path, line, id, &made)) < 0)
        return rc;
    strcat(line, "\n");
    rc = write_file(c, path, 077, line);
    explicit_bzero(line, sizeof line);
    snprintf(path, sizeof path, "%s/radd.conf", folder);
    make_settings(c, text, sizeof text);
    if (rc == 0)
        rc = write_file(c, path, 022, text);
    if (rc == 0)
        json_array_append_new(e->done, json_pack("{s:s,s:s,s:s,s:s}", "worker",
                                                 worker, "key", id, "made",
                                                 made ? "now" : "before",
                                                 "folder", folder));
    return rc;
}

/* --- the command --- */

static int
check_names(const struct ctl *c)
{
    for (int i = 0; i < c->nargs; i++)
        if (c->args[i][0] == '.' ||
            !key_name_valid(c->args[i], strlen(c->args[i])))
            return rad_fail(c->err, RAD_EUSAGE,
                            "'%.80s': a worker's name needs letters, digits, "
                            "'.', '_' or '-', and begins with no '.'",
                            c->args[i]);
    return 0;
}

int
ctl_check_enroll(struct ctl *c)
{
    int rc = check_names(c);

    if (rc < 0)
        return rc;
    if (!c->folder || !c->folder[0])
        return rad_fail(c->err, RAD_EUSAGE, "enroll needs --output=DIR");
    rc = target_find(&c->to, c->coordinator, c->key, c->err);
    if (rc < 0)
        return rc;
    if (rc == 0 || c->to.local)
        return rad_fail(c->err, RAD_EUSAGE,
                        "enroll: --coordinator=HOST:PORT must say where "
                        "workers dial");
    return 0;
}

/* Is it a name by which each host calls itself? */
static bool
is_loopback(const char *host)
{
    return strcmp(host, "localhost") == 0 || strcmp(host, "::1") == 0 ||
           strncmp(host, "127.", 4) == 0;
}

static void
tell_what_to_do(const struct ctl *c, const json_t *done)
{
    table_print(stdout, done);
    tell(stdout, "%s", "");
    tell(stdout, "Copy to each host, for example WORKER, as root:");
    tell(stdout, "    ssh root@WORKER mkdir -p %s", SETTINGS);
    tell(stdout, "    scp %s/WORKER/radd.conf %s/WORKER/key root@WORKER:%s/",
         c->folder, c->folder, SETTINGS);
    tell(stdout,
         "    ssh root@WORKER 'chmod 600 %s/key && systemctl restart radd'",
         SETTINGS);
    tell(stdout, "and remove %s: who reads a key can be that worker.",
         c->folder);
}

int
ctl_run_enroll(struct ctl *c)
{
    struct enroll e = { .c = c };
    int rc = rad_make_dir(c->folder, 0700, c->err);

    if (rc == 0 && is_loopback(c->to.host))
        tell(stderr,
             "radctl: warning: '%s' is each host itself: with "
             "--coordinator=HOST:PORT name this machine as other hosts do",
             c->to.host);
    if (rc == 0)
        rc = list_keys(&e);
    e.done = json_array();
    for (int i = 0; rc == 0 && i < c->nargs; i++)
        rc = enroll_one(&e, c->args[i]);
    if (json_array_size(e.done) > 0 && c->json)
        table_print_json(stdout, e.done);
    else if (json_array_size(e.done) > 0)
        tell_what_to_do(c, e.done);
    json_decref(e.keys);
    json_decref(e.done);
    return rc;
}
