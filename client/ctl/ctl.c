/* ctl.c - see ctl.h */
#include "config.h"

#include "ctl/ctl.h"

#include "common/tell.h"

#include <stdio.h>
#include <string.h>

enum {
    CONNECT_MS = 3000,
    ANSWER_MS = 4500 /* from the start: status 69 comes within 5 s */
};

int
ctl_connect(struct ctl *c)
{
    const struct target *to = &c->to;
    struct link_where where = { &c->loop, &c->wake };
    int rc;

    c->local = to->local;
    c->role = link_role(to);
    rc = link_open(&c->link, &where, to, c->role, CONNECT_MS, c->err);
    if (rc == RAD_EPERM && to->local) {
        *c->err = (struct rad_error){ 0 };
        c->role = MSG_ROLE_USER;
        rc = link_open(&c->link, &where, to, c->role, CONNECT_MS, c->err);
    }
    return rc;
}

int
ctl_ask(struct ctl *c, struct msg *m, const struct msg **answer)
{
    int rc, left;

    m->request = ++c->request;
    if ((rc = link_send(c->link, m, c->err)) < 0)
        return rc;
    for (;;) {
        uv_update_time(&c->loop);
        left = ANSWER_MS - (int)(uv_now(&c->loop) - c->start_ms);
        rc = link_recv(c->link, left > 0 ? left : 0, answer, c->err);
        if (rc < 0)
            return rc;
        if (rc == 0)
            return rad_fail(c->err, RAD_EUNAVAIL,
                            "the coordinator does not answer");
        if ((*answer)->request != c->request)
            continue;
        c->start_ms = uv_now(&c->loop); /* for the next command */
        if ((*answer)->type == MSG_FAILED)
            return rad_fail(c->err, link_code((*answer)->failed.status), "%s",
                            (*answer)->failed.text);
        if ((*answer)->type == MSG_ANSWER)
            return 0;
    }
}

int
ctl_query(struct ctl *c, int what, const char *text, const struct msg **answer)
{
    struct msg m = { .type = MSG_QUERY };

    m.query.what = (uint8_t)what;
    m.query.text = text ? text : "";
    return ctl_ask(c, &m, answer);
}

json_t *
ctl_parse(struct ctl *c, const struct msg *answer)
{
    json_error_t why;
    json_t *root = json_loadb((const char *)answer->answer.text,
                              answer->answer.len, 0, &why);

    if (!root)
        rad_fail(c->err, RAD_EPROTO, "the coordinator's answer is no JSON: %s",
                 why.text);
    return root;
}

int
ctl_find_job(struct ctl *c, uint8_t job[MSG_JOB])
{
    const struct msg *answer;
    const char *id;
    json_t *root;
    int rc = 0;

    if (msg_job_parse(c->arg, job))
        return 0;
    if ((rc = ctl_query(c, MSG_QUERY_JOB, c->arg, &answer)) < 0)
        return rc;
    root = ctl_parse(c, answer);
    if (!root)
        return c->err->code;
    id = json_string_value(json_object_get(root, "job"));
    if (!id || !msg_job_parse(id, job))
        rc = rad_fail(c->err, RAD_EPROTO,
                      "the coordinator's answer names no "
                      "job");
    json_decref(root);
    return rc;
}

int
ctl_each(struct ctl *c, int (*fn)(struct ctl *c))
{
    struct rad_error *first = c->err, err;
    char text[600];
    int rc = 0, failed = 0, code = 0;

    if (c->nargs <= 1)
        return fn(c);
    for (int i = 0; i < c->nargs && rc != RAD_EUNAVAIL; i++) {
        err = (struct rad_error){ 0 };
        c->err = &err;
        c->arg = c->args[i];
        if ((rc = fn(c)) == 0)
            continue;
        rad_error_format(&err, text, sizeof text);
        tell(stderr, "radctl: %s: %s", c->arg, text);
        code = failed++ == 0 ? rc : code;
    }
    c->err = first;
    return failed == 0 ? 0
                       : rad_fail(c->err, code, "%s: %d of %d failed",
                                  c->command->name, failed, c->nargs);
}

int
ctl_done(const struct ctl *c)
{
    if (c->json)
        puts("{ \"ok\": true }");
    return 0;
}
