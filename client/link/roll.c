/* roll.c - see roll.h */
#include "config.h"

#include "link/roll.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

static void
call_roll(struct roll *r, const json_t *workers)
{
    size_t i, at = strlen(r->names);
    const json_t *w;

    json_array_foreach(workers, i, w)
    {
        const char *state = json_string_value(json_object_get(w, "state"));
        const char *name = json_string_value(json_object_get(w, "name"));

        if (!state || !name || strcmp(state, "gone") == 0)
            continue;
        if (at < sizeof r->names)
            at += (size_t)snprintf(r->names + at, sizeof r->names - at, "%s%s",
                                   r->n > 0 ? ", " : "", name);
        r->busy |=
            strcmp(state, "working") == 0 || strcmp(state, "loading") == 0;
        r->n++;
    }
    if (at >= sizeof r->names)
        strcpy(r->names + sizeof r->names - 5, " ...");
}

int
roll_page(struct roll *r, const struct msg_answer *answer, uint64_t *next,
          struct rad_error *err)
{
    json_t *page;

    errno = 0;
    page = answer ? json_loadb((const char *)answer->text, answer->len, 0, NULL)
                  : NULL;
    if (!page && errno == ENOMEM) /* else jansson does not tell */
        return rad_fail_memory(err);
    if (!page)
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator's answer is no list of workers");
    call_roll(r, json_object_get(page, "rows"));
    *next = (uint64_t)json_integer_value(json_object_get(page, "next"));
    json_decref(page);
    return 0;
}
