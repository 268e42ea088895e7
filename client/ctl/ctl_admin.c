/* ctl_admin.c - radctl's commands for administrators: workers, keys, and the
 * state folder of a coordinator on this machine */
#include "config.h"

#include "ctl/ctl.h"
#include "common/table.h"
#include "common/tell.h"
#include "store/statecheck.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Send the command's message about a worker. */
static int
steer(struct ctl *c)
{
    struct msg m = { .type = (uint16_t)c->command->number };
    const struct msg *answer;

    m.drain.name = c->arg;
    return ctl_ask(c, &m, &answer);
}

int
ctl_run_worker(struct ctl *c)
{
    int rc = ctl_each(c, steer);

    return rc < 0 ? rc : ctl_done(c);
}

/* --- keys --- */

/* Make the order of the words after "key". */
static int
parse_key_order(struct ctl *c)
{
    static const char *const words[] = { [MSG_KEY_ADD] = "add",
                                         [MSG_KEY_RETIRE] = "retire",
                                         [MSG_KEY_LIST] = "list" };
    const char *what = c->arg, *name = c->name;
    int i = 0;

    while (i < MSG_NKEY && strcmp(words[i], what) != 0)
        i++;
    if (i == MSG_NKEY)
        return rad_fail(c->err, RAD_EUSAGE,
                        "unknown command 'key %s': expected add, retire or "
                        "list",
                        what);
    c->order = (struct key_order){ .what = (enum msg_key_order)i,
                                   .name = name ? name : "" };
    if (i != MSG_KEY_LIST && !name)
        return rad_fail(c->err, RAD_EUSAGE,
                        "command 'key %s': missing ROLE:NAME", what);
    if (i == MSG_KEY_LIST && name)
        return rad_fail(c->err, RAD_EUSAGE, "unexpected word '%s'", name);
    if (strlen(c->order.name) >= KEY_ID)
        return rad_fail(c->err, RAD_EUSAGE, "the key's name is too long");
    if (c->expires && i != MSG_KEY_ADD)
        return rad_fail(c->err, RAD_EUSAGE,
                        "--expires goes with key add alone");
    return c->expires ? key_date_parse(c->expires, &c->order.expires, c->err)
                      : 0;
}

int
ctl_check_key(struct ctl *c)
{
    int rc = parse_key_order(c);

    if (rc < 0)
        return rc;
    if (c->order.what == MSG_KEY_LIST)
        return ctl_check_list(c);
    if (c->state || c->limit || c->user)
        return rad_fail(c->err, RAD_EUSAGE,
                        "--state, --limit and --user go with key list alone");
    return key_order_check(&c->order, (int64_t)time(NULL), c->err);
}

static int
print_new_key(const json_t *root, struct rad_error *err)
{
    const char *line = json_string_value(json_object_get(root, "line"));

    if (!line)
        return rad_fail(err, RAD_EPROTO, "the answer holds no key");
    tell(stdout, "%s", line);
    return 0;
}

/* Print an answer: with --json as it is; else the line of a new key, or a table
 * of a list. */
static int
print_keys(struct ctl *c, const char *text, size_t len)
{
    json_error_t why;
    json_t *root = json_loadb(text, len, 0, &why);
    int rc = 0;

    if (!root)
        return rad_fail(c->err, RAD_EPROTO, "the answer is no JSON: %s",
                        why.text);
    if (c->order.what == MSG_KEY_LIST)
        ctl_filter(c, root, "name");
    if (c->json)
        table_print_json(stdout, root);
    else if (c->order.what == MSG_KEY_ADD)
        rc = print_new_key(root, c->err);
    else
        table_print(stdout, root);
    json_decref(root);
    return rc;
}

/* key: edit the file, if --keys names one; else the coordinator does */
static int
run_key_file(struct ctl *c)
{
    char *text;
    int rc =
        key_order_run(c->keys, &c->order, (int64_t)time(NULL), &text, c->err);

    if (rc == 0)
        rc = print_keys(c, text, strlen(text));
    if (text)
        explicit_bzero(text, strlen(text));
    free(text);
    return rc;
}

int
ctl_run_key(struct ctl *c)
{
    struct msg m = { .type = MSG_KEY,
                     .key = { (uint8_t)c->order.what, c->order.name,
                              (uint64_t)c->order.expires } };
    const struct msg *answer;
    int rc;

    if (c->keys)
        return run_key_file(c);
    rc = ctl_ask(c, &m, &answer);
    return rc < 0 ? rc
                  : print_keys(c, (const char *)answer->answer.text,
                               answer->answer.len);
}

/* --- a state folder --- */

static void
tell_finding(void *arg, bool problem, const char *text)
{
    struct ctl *c = arg;
    char *clean;

    if (!c->problems) {
        tell(stdout, "%s: %s", problem ? "problem" : "to be made again", text);
    } else if (problem && (clean = strdup(text)) != NULL) {
        rad_text_clean(clean); /* the name may not be UTF-8 */
        json_array_append_new(c->problems, json_string(clean));
        free(clean);
    }
}

/* The first word of the answer.  If something could not be read the folder
 * cannot be called sound. */
static const char *
verdict(const struct statecheck *found)
{
    return found->problems ? "damaged" : found->denied ? "not known" : "sound";
}

static void
print_check(struct ctl *c, const struct statecheck *found)
{
    uint32_t problems = found->problems + found->denied;
    json_t *root;

    if (!c->problems && found->redo > 0)
        printf("the rows of %u unit%s will be made again: is the disk sound?\n",
               found->redo, found->redo == 1 ? "" : "s");
    if (!c->problems) {
        printf("%s: %u job%s, %u of them not over; %u problem%s\n",
               verdict(found), found->jobs, found->jobs == 1 ? "" : "s",
               found->open, problems, problems == 1 ? "" : "s");
        return;
    }
    root = json_pack("{s:b,s:i,s:i,s:i,s:O}", "sound", problems == 0, "jobs",
                     (int)found->jobs, "open", (int)found->open, "redo",
                     (int)found->redo, "problems", c->problems);
    table_print_json(stdout, root);
    json_decref(root);
}

/* check: a state folder on this machine */
int
ctl_run_check(struct ctl *c)
{
    struct statecheck found;
    int rc;

    c->problems = c->json ? json_array() : NULL;
    rc = statecheck_run(c->arg, &found, tell_finding, c, c->err);
    if (rc == 0)
        print_check(c, &found);
    json_decref(c->problems);
    if (rc == 0 && found.problems > 0)
        rc = rad_fail(c->err, RAD_EDATA,
                      "'%s' is damaged: put a backup in its place, or move it "
                      "away to begin without its jobs",
                      c->arg);
    else if (rc == 0 && found.denied > 0)
        rc = rad_fail(c->err, RAD_EPERM,
                      "'%s': rights are not as radcoord needs them, or not all "
                      "of it may be read: ask as root or as the user that "
                      "radcoord runs as",
                      c->arg);
    return rc;
}
