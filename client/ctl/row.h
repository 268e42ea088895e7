/* row.h - members of a row that the coordinator gave, as JSON
 *
 * Thread: any; pure functions of the row. */
#ifndef CLIENT_ROW_H
#define CLIENT_ROW_H

#include <jansson.h>

/* "" where it is none; borrowed from the row. */
static inline const char *
row_text(const json_t *row, const char *key)
{
    const char *text = json_string_value(json_object_get(row, key));

    return text ? text : "";
}

/* 0 where it is none. */
static inline double
row_number(const json_t *row, const char *key)
{
    return json_number_value(json_object_get(row, key));
}

#endif
