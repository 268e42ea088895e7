/* row.h - members of a row of the coordinator's, in JSON
 *
 * Thread: any; pure functions of the row. */
#ifndef CLIENT_ROW_H
#define CLIENT_ROW_H

#include <jansson.h>

/* A text; "" if the row has none.  Borrowed from the row. */
static inline const char *
row_text(const json_t *row, const char *key)
{
    const char *text = json_string_value(json_object_get(row, key));

    return text ? text : "";
}

/* A number; 0 if the row has none. */
static inline double
row_number(const json_t *row, const char *key)
{
    return json_number_value(json_object_get(row, key));
}

/* The ending of a noun for so many. */
static inline const char *
row_plural(double n)
{
    return n == 1 ? "" : "s";
}

#endif
