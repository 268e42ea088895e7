/* top_rows.h - the rows of radctl top's lists, and their columns
 *
 * Private to top.c and top_lines.c, and their tests.
 * Thread: one. */
#ifndef RADD_CLIENT_TOP_ROWS_H
#define RADD_CLIENT_TOP_ROWS_H

#include "ctl/top.h"

enum top_kind {
    TOP_TEXT,
    TOP_ID,
    TOP_COUNT,
    TOP_MANY, /* such as 1.2 M */
    TOP_LOAD,
    TOP_OF, /* number, and that of all workers */
    TOP_RATE,
    TOP_SHARE,
    TOP_SMALL,
    TOP_BYTES,
    TOP_SPAN,
    TOP_PASS
};

struct top_column {
    const char *title, *key;
    enum top_kind kind;
    int width;
    int rank;  /* of columns that do not fit, the highest go first */
    bool wide; /* gets the width that is left */
};

/* The columns of a list, top_ncolumns() of them. */
const struct top_column *top_columns(enum top_pane pane);
int top_ncolumns(enum top_pane pane);

/* The name of a worker, the id of a job; "": row is NULL. */
const char *top_name(enum top_pane pane, const json_t *row);

/* The row of that name in a list, borrowed; NULL: there is none. */
const json_t *top_row(const struct top *t, enum top_pane pane,
                      const char *name);

/* The number that a column sorts by; -1: it has none. */
double top_value(const struct top *t, enum top_pane pane,
                 const struct top_column *c, const json_t *row);

/* The rows that the filter selects, in their order: *n of them, borrowed, in an
 * array to be freed.  NULL: memory is out. */
const json_t **top_rows(const struct top *t, enum top_pane pane, size_t *n);

/* The index of the row of that name in such an array; 0 if there is none. */
size_t top_place(const json_t **v, size_t n, enum top_pane pane,
                 const char *name);

/* The chosen row of a list, borrowed; NULL: the list is empty. */
const json_t *top_chosen(const struct top *t, enum top_pane pane);

#endif
