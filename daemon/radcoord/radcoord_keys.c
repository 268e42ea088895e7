/* radcoord_keys.c - the coordinator daemon's key file; see radcoord_impl.h */
#include "config.h"

#include "radcoord/radcoord_impl.h"

#include "net/key/keyorder.h"
#include "net/log.h"

#include "base/list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

bool
radcoord_note_key(struct radcoord *r, const struct key *k, const char *id)
{
    size_t i = 0;

    while (i < r->nworker_keys && strcmp(r->worker_keys[i].name, k->name) != 0)
        i++;
    if (i == r->nworker_keys) {
        if (!rad_list_grow(&r->worker_keys, i, sizeof *r->worker_keys))
            return false;
        r->nworker_keys++;
        snprintf(r->worker_keys[i].name, sizeof r->worker_keys[i].name, "%s",
                 k->name);
    }
    snprintf(r->worker_keys[i].id, sizeof r->worker_keys[i].id, "%s", id);
    return true;
}

/* End what hangs on keys that are no longer valid: links of workers with other
 * workers, of which a worker that is not connected just now may have some, too;
 * then connections. */
static void
drop_keys(struct radcoord *r)
{
    for (size_t i = r->nworker_keys; i-- > 0;) {
        struct worker_key *k = &r->worker_keys[i];
        const char *fault = keyring_fault(r->keys, k->id);

        if (!fault)
            continue;
        log_warn("worker expelled name=%s key=%s: %s", k->name, k->id, fault);
        coord_expel(r->coord, radcoord_now(r), k->name);
        *k = r->worker_keys[--r->nworker_keys];
    }
    shell_drop_keys(&r->shell, keyring_fault, r->keys);
}

/* Read the key file again, and close connections whose key is no longer valid.
 */
static int
reload_keys(struct radcoord *r, struct rad_error *err)
{
    int rc = keyring_reload(r->keys, err);

    if (rc < 0)
        return rc;
    drop_keys(r);
    keyring_settle(r->keys);
    return 0;
}

void
radcoord_reload_keys(struct radcoord *r)
{
    struct rad_error err = { 0 };
    char text[600];

    if (reload_keys(r, &err) == 0)
        return;
    rad_error_format(&err, text, sizeof text);
    log_err("keys not reloaded: %s", text);
}

/* The file is looked at once a second. */
void
radcoord_tick_keys(struct radcoord *r)
{
    if (!keyring_has_file(r->keys) || radcoord_now(r) - r->keys_ms < 1000)
        return;
    r->keys_ms = radcoord_now(r);
    if (keyring_changed(r->keys)) {
        log_info("key file changed");
        radcoord_reload_keys(r);
    } else {
        drop_keys(r);
    }
}

static int
order_key(struct radcoord *r, const struct msg_key *m, const char *by,
          char **json, struct rad_error *err)
{
    struct key_order order = { (enum msg_key_order)m->what, m->name,
                               (int64_t)m->expires, true };
    int rc;

    if (!keyring_has_file(r->keys))
        return rad_fail(err, RAD_ENOINPUT,
                        "the coordinator was started without a key file");
    rc = key_order_run(keyring_path(r->keys), &order, (int64_t)time(NULL), json,
                       err);
    if (rc < 0 || m->what == MSG_KEY_LIST)
        return rc;
    log_info("key %s name=%s by=%s",
             m->what == MSG_KEY_ADD ? "added" : "retired", m->name, by);
    return reload_keys(r, err);
}

/* An administrator who retires the key of this very connection gets no answer:
 * the connection is closed before an answer could be sent. */
void
radcoord_do_key(struct radcoord *r, const struct action *a)
{
    struct msg m = { .type = MSG_ANSWER, .request = a->request };
    struct rad_error err = { 0 };
    char text[MSG_MAX_TEXT + 1];
    struct conn *c;
    char *json = NULL;
    int rc = order_key(r, &a->key, a->text, &json, &err);

    c = shell_conn(&r->shell, a->conn);
    if (rc == 0) {
        m.answer.text = (const uint8_t *)json;
        m.answer.len = strlen(json);
    } else {
        rad_error_format(&err, text, sizeof text);
        m.type = MSG_FAILED;
        m.failed = (struct msg_failed){ .status = (uint16_t)rad_exit_status(rc),
                                        .text = text };
        if (a->key.what != MSG_KEY_LIST)
            log_warn("key file not changed name=%s why=%s", a->key.name, text);
    }
    if (c)
        conn_send(c, &m);
    if (json)
        explicit_bzero(json, strlen(json));
    free(json);
}
