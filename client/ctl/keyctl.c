/* keyctl.c - see keyctl.h */
#include "config.h"

#include "ctl/keyctl.h"

#include "common/table.h"
#include "common/tell.h"

#include <string.h>

int
keyctl_parse(struct key_order *order, const char *what, const char *name,
             const char *expires, struct rad_error *err)
{
    static const char *const words[] = { [MSG_KEY_ADD] = "add",
                                         [MSG_KEY_RETIRE] = "retire",
                                         [MSG_KEY_LIST] = "list" };
    int i = 0;

    while (i < MSG_NKEY && strcmp(words[i], what) != 0)
        i++;
    if (i == MSG_NKEY)
        return rad_fail(err, RAD_EUSAGE,
                        "unknown command 'key %s': expected add, retire or "
                        "list",
                        what);
    *order = (struct key_order){ .what = (enum msg_key_order)i,
                                 .name = name ? name : "" };
    if (i != MSG_KEY_LIST && !name)
        return rad_fail(err, RAD_EUSAGE, "command 'key %s': missing ROLE:NAME",
                        what);
    if (i == MSG_KEY_LIST && name)
        return rad_fail(err, RAD_EUSAGE, "unexpected word '%s'", name);
    if (strlen(order->name) >= KEY_ID)
        return rad_fail(err, RAD_EUSAGE, "the key's name is too long");
    if (expires && i != MSG_KEY_ADD)
        return rad_fail(err, RAD_EUSAGE, "--expires goes with key add alone");
    return expires ? key_date_parse(expires, &order->expires, err) : 0;
}

static int
print_line(const json_t *root, struct rad_error *err)
{
    const char *line = json_string_value(json_object_get(root, "line"));

    if (!line)
        return rad_fail(err, RAD_EPROTO, "the answer holds no key");
    tell(stdout, "%s", line);
    return 0;
}

int
keyctl_print(const struct key_order *order, const json_t *root, bool json,
             struct rad_error *err)
{
    if (json)
        table_print_json(stdout, root);
    else if (order->what == MSG_KEY_ADD)
        return print_line(root, err);
    else
        table_print(stdout, root);
    return 0;
}
