/* markup.h - text that grows, and what may stand in HTML, JSON and metrics
 *
 * Raw pieces and formats are the program's own words and numbers; what somebody
 * else chose (names of jobs, users, workers, files) goes through
 * markup_text() or markup_json() alone, which leave nothing in it that a
 * browser takes for its own.  A failure of memory sticks: the text is NULL at
 * the end.
 * Thread: a struct belongs to one thread. */
#ifndef RADD_OBSERVER_MARKUP_H
#define RADD_OBSERVER_MARKUP_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

struct markup {
    char *text; /* terminated; NULL while it is empty */
    size_t len, cap;
    bool failed;
};

void markup_raw(struct markup *m, const char *s);
void markup_bytes(struct markup *m, const char *s, size_t n);
void markup_print(struct markup *m, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/* Add text of others as HTML, in an element or a quoted attribute: unsafe
 * characters (base/text.h) become '?'.  NULL adds nothing. */
void markup_text(struct markup *m, const char *s);
/* A value as JSON, on one line. */
void markup_json(struct markup *m, const json_t *value);

/* A number as people read it: "0", "12.3 k", "4.56 M". */
void markup_count(struct markup *m, double v);
/* "1.20 MB" */
void markup_size(struct markup *m, double v);
/* So many seconds: "5 s", "12 min", "3 h 20 min", "4 days". */
void markup_span(struct markup *m, double s);

/* A member of a row that the coordinator sent; "" or 0: the row lacks it. */
const char *markup_member(const json_t *row, const char *key);
double markup_number(const json_t *row, const char *key);

/* Return the text, which the caller frees, and set *len (or NULL); NULL: memory
 * was out.  The struct is empty again. */
char *markup_take(struct markup *m, size_t *len);
void markup_release(struct markup *m);

#endif
