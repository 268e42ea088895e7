/* top_rows.c - see top_rows.h */
#include "config.h"

#include "ctl/top_rows.h"

#include "ctl/row.h"
#include "machine/lists.h"

#include <stdlib.h>
#include <string.h>

static const struct top_column tables[TOP_NPANE][12] = {
    { { "WORKER", "name", TOP_TEXT, 10, 0, true },
      { "STATE", "state", TOP_TEXT, 8, 0, false },
      { "LOAD", "load", TOP_LOAD, 4, 3, false },
      { "THREADS", "threads", TOP_COUNT, 7, 4, false },
      { "UNITS", "units", TOP_COUNT, 5, 2, false },
      { "RAYS/S", "", TOP_RATE, 7, 1, false },
      { "REDUNDANT", "redundant", TOP_MANY, 9, 6, false },
      { "MEMORY", "memory", TOP_BYTES, 8, 5, false },
      { "CACHE", "cache", TOP_MANY, 6, 7, false },
      { "FOR", "since_s", TOP_SPAN, 8, 8, false },
      { "ADDRESS", "address", TOP_TEXT, 21, 9, false } },
    { { "JOB", "job", TOP_ID, 8, 0, false },
      { "NAME", "name", TOP_TEXT, 10, 3, true },
      { "STATE", "state", TOP_TEXT, 9, 0, false },
      { "DONE", "done", TOP_SHARE, 5, 0, false },
      { "LEFT", "left_s", TOP_SPAN, 8, 1, false },
      { "RAYS/S", "", TOP_RATE, 7, 2, false },
      { "WORKERS", "workers", TOP_OF, 7, 4, false },
      { "ERROR", "error", TOP_SMALL, 6, 5, false },
      { "OWNER", "owner", TOP_TEXT, 8, 6, false },
      { "PASS", "", TOP_PASS, 5, 7, false },
      { "REDUNDANT", "ambient_redundant", TOP_MANY, 9, 8, false },
      { "PRIORITY", "priority", TOP_COUNT, 8, 9, false } },
};

const char *
top_name(enum top_pane pane, const json_t *row)
{
    return row_text(row, pane == TOP_JOBS ? "job" : "name");
}

const struct top_column *
top_columns(enum top_pane pane)
{
    return tables[pane];
}

int
top_ncolumns(enum top_pane pane)
{
    int n = 0;

    while (n < 12 && tables[pane][n].title)
        n++;
    return n;
}

const json_t *
top_row(const struct top *t, enum top_pane pane, const char *name)
{
    const json_t *row;
    size_t i;

    json_array_foreach(t->list[pane].rows, i, row)
    {
        if (strcmp(top_name(pane, row), name) == 0)
            return row;
    }
    return NULL;
}

double
top_value(const struct top *t, enum top_pane pane, const struct top_column *c,
          const json_t *row)
{
    const json_t *x = json_object_get(row, c->key);

    switch (c->kind) {
    case TOP_RATE:
        x = json_object_get(t->list[pane].rates, top_name(pane, row));
        break;
    case TOP_PASS:
        x = json_object_get(row, "pass");
        break;
    default:
        break;
    }
    return json_is_number(x) ? json_number_value(x) : -1;
}

/* --- selection and order --- */

static bool
fits(const struct top *t, const json_t *row)
{
    static const char *const where[] = { "name", "job", "owner", "state" };

    for (size_t i = 0; i < sizeof where / sizeof where[0]; i++)
        if (strcasestr(row_text(row, where[i]), t->filter))
            return true;
    return false;
}

static int
compare(const struct top *t, enum top_pane pane, int column, const json_t *a,
        const json_t *b)
{
    const struct top_column *c = &tables[pane][column];
    double x, y;

    if (c->kind == TOP_TEXT || c->kind == TOP_ID)
        return strcmp(row_text(a, c->key), row_text(b, c->key));
    x = top_value(t, pane, c, a);
    y = top_value(t, pane, c, b);
    return x > y ? -1 : x < y; /* the largest first */
}

struct order {
    const struct top *t;
    enum top_pane pane;
};

static int
by_column(const void *a, const void *b, void *arg)
{
    const struct order *o = arg;
    const struct top_list *l = &o->t->list[o->pane];
    const json_t *p = *(const json_t *const *)a, *q = *(const json_t *const *)b;
    int c = compare(o->t, o->pane, l->sort, p, q);

    if (c == 0) /* by name, so that rows stay in place */
        return strcmp(top_name(o->pane, p), top_name(o->pane, q));
    return l->back ? -c : c;
}

/* Jobs that are not over, as they are served; behind them those that are, the
 * newest first. */
static json_t *
in_order(const json_t *rows)
{
    json_t *open = json_array(), *over = json_array(), *list, *row;
    size_t i;

    json_array_foreach(rows, i, row)
        json_array_append(lists_is_over(row) ? over : open, row);
    list = lists_served(open);
    json_array_extend(list, over);
    json_decref(open);
    json_decref(over);
    return list;
}

const json_t **
top_rows(const struct top *t, enum top_pane pane, size_t *n)
{
    json_t *rows = t->list[pane].rows, *row;
    const json_t **v = calloc(json_array_size(rows) + 1, sizeof *v);
    bool sorted = t->list[pane].sort >= 0;
    struct order o = { t, pane };
    size_t i;

    rows = pane == TOP_JOBS && !sorted ? in_order(rows) : json_incref(rows);

    *n = 0;
    json_array_foreach(rows, i, row)
    {
        if (v && fits(t, row))
            v[(*n)++] = row;
    }
    json_decref(rows); /* the list still has references */
    if (v && sorted)
        qsort_r(v, *n, sizeof *v, by_column, &o);
    return v;
}

size_t
top_place(const json_t **v, size_t n, enum top_pane pane, const char *name)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(top_name(pane, v[i]), name) == 0)
            return i;
    return 0;
}

const json_t *
top_chosen(const struct top *t, enum top_pane pane)
{
    size_t n;
    const json_t **v = top_rows(t, pane, &n), *row = NULL;

    if (v && n > 0)
        row = v[top_place(v, n, pane, t->list[pane].chosen)];
    free(v);
    return row;
}
