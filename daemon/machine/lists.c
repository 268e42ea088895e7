/* lists.c - see lists.h */
#include "config.h"

#include "machine/lists.h"

#include <stdlib.h>
#include <string.h>

/* A job's row, and its index in the list. */
struct place {
    json_t *row;
    json_int_t priority;
    size_t at;
};

static int
by_priority(const void *a, const void *b)
{
    const struct place *p = a, *q = b;

    if (p->priority != q->priority)
        return p->priority < q->priority ? 1 : -1;
    return p->at < q->at ? 1 : -1;
}

json_t *
lists_served(const json_t *rows)
{
    size_t n = json_array_size(rows);
    struct place *v = calloc(n + 1, sizeof *v);
    json_t *list = json_array();

    for (size_t i = 0; v && i < n; i++) {
        json_t *row = json_array_get(rows, i);

        v[i] = (struct place){
            row, json_integer_value(json_object_get(row, "priority")), i
        };
    }
    if (v)
        qsort(v, n, sizeof *v, by_priority);
    for (size_t i = 0; v && i < n; i++)
        json_array_append(list, v[i].row);
    free(v);
    return list;
}

bool
lists_is_over(const json_t *job)
{
    const char *is = json_string_value(json_object_get(job, "state"));

    return is && (strcmp(is, "done") == 0 || strcmp(is, "failed") == 0 ||
                  strcmp(is, "cancelled") == 0);
}

json_t *
lists_words(const char *text)
{
    json_t *list = json_array();

    while (*text) {
        size_t n = strcspn(text, " ");

        if (n > 0)
            json_array_append_new(list, json_stringn(text, n));
        text += n + (text[n] == ' ');
    }
    return list;
}
