/* table.c - see table.h */
#include "config.h"

#include "common/table.h"

#include "base/text.h"
#include "common/tell.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    CELL = 256,   /* most bytes of a cell, with its NUL */
    COLUMNS = 60, /* most columns of the terminal for a cell */
    MOST_KEYS = 64
};

static void
format_number(char cell[CELL], const json_t *value)
{
    double v = json_number_value(value);

    if (json_is_integer(value))
        snprintf(cell, CELL, "%" JSON_INTEGER_FORMAT,
                 json_integer_value(value));
    else if (fabs(v) < 1e9)
        snprintf(cell, CELL, "%.3f", v);
    else
        snprintf(cell, CELL, "%.6g", v);
}

/* A text that is too wide ends in three dots. */
static void
format_text(char cell[CELL], const char *text)
{
    bool cut = strlen(text) >= CELL;

    rad_text_print(cell, CELL, "%s", text);
    rad_text_clean(cell);
    if (cut || rad_text_width(cell) > COLUMNS)
        strcpy(cell + rad_text_fit(cell, COLUMNS - 3), "...");
}

/* Format a value in one line. */
static void
format_cell(char cell[CELL], const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_STRING:
        format_text(cell,
                    json_string_length(value) ? json_string_value(value) : "-");
        break;
    case JSON_INTEGER:
    case JSON_REAL:
        format_number(cell, value);
        break;
    case JSON_TRUE:
        strcpy(cell, "yes");
        break;
    case JSON_FALSE:
        strcpy(cell, "no");
        break;
    case JSON_ARRAY:
        snprintf(cell, CELL, "(%zu)", json_array_size(value));
        break;
    case JSON_OBJECT:
        snprintf(cell, CELL, "{%zu}", json_object_size(value));
        break;
    default:
        strcpy(cell, "-");
    }
}

static void
put_cell(FILE *to, const char *cell, size_t width, bool right, bool last)
{
    size_t n = rad_text_width(cell);
    int pad = n < width ? (int)(width - n) : 0;

    if (right)
        fprintf(to, "%*s%s", pad, "", cell);
    else
        fprintf(to, "%s%*s", cell, last ? 0 : pad, "");
    fputs(last ? "\n" : "  ", to);
}

/* The width of a column's widest cell, including the column's name. */
static size_t
column_width(const json_t *rows, const char *key)
{
    size_t i, n, width = rad_text_width(key);
    const json_t *row, *value;
    char cell[CELL];

    json_array_foreach(rows, i, row)
    {
        value = json_object_get(row, key);
        if (value) {
            format_cell(cell, value);
            n = rad_text_width(cell);
            width = n > width ? n : width;
        }
    }
    return width;
}

/* Print a row; row NULL: the names of the columns. */
static void
put_row(FILE *to, const json_t *first, const size_t width[MOST_KEYS],
        const json_t *row)
{
    size_t k = 0, n = json_object_size(first);
    const char *key;
    const json_t *shown, *value;
    char cell[CELL];

    json_object_foreach((json_t *)first, key, shown)
    {
        value = row ? json_object_get(row, key) : NULL;
        if (value)
            format_cell(cell, value);
        else
            format_text(cell, row ? "-" : key);
        put_cell(to, cell, width[k], json_is_number(shown), k + 1 == n);
        k++;
    }
}

static void
print_rows(FILE *to, const char *name, const json_t *rows)
{
    const json_t *first = json_array_get(rows, 0), *row, *shown;
    size_t i, k = 0, n = json_array_size(rows), width[MOST_KEYS];
    const char *key;

    if (n == 0) {
        tell(to, "no %s", name);
        return;
    }
    if (!json_is_object(first) || json_object_size(first) > MOST_KEYS) {
        tell(to, "%s: %zu", name, n);
        return;
    }
    json_object_foreach((json_t *)first, key, shown) width[k++] =
        column_width(rows, key);
    put_row(to, first, width, NULL);
    json_array_foreach(rows, i, row) put_row(to, first, width, row);
}

/* Print the members of an object that are plain values, names in one column. */
static bool
print_plain(FILE *to, const json_t *object)
{
    size_t width = 0;
    const char *key;
    json_t *value;
    char cell[CELL];
    bool any = false;

    json_object_foreach((json_t *)object, key,
                        value) if (!json_is_object(value) &&
                                   !json_is_array(value) && strlen(key) > width)
        width = strlen(key);
    json_object_foreach((json_t *)object, key, value)
    {
        if (json_is_object(value) || json_is_array(value))
            continue;
        any = true;
        if (json_is_string(value)) { /* printed whole */
            tell(to, "%-*s  %s", (int)width, key, json_string_value(value));
            continue;
        }
        format_cell(cell, value);
        tell(to, "%-*s  %s", (int)width, key, cell);
    }
    return any;
}

void
table_print(FILE *to, const json_t *root)
{
    const char *key;
    json_t *value;
    bool above;

    if (json_is_array(root)) {
        print_rows(to, "entries", root);
        return;
    }
    above = print_plain(to, root);
    json_object_foreach((json_t *)root, key, value)
    {
        if (!json_is_object(value) && !json_is_array(value))
            continue;
        if (above)
            fputc('\n', to);
        above = true;
        if (json_is_array(value)) {
            print_rows(to, key, value);
        } else {
            tell(to, "%s", key);
            print_plain(to, value);
        }
    }
}

void
table_print_json(FILE *to, const json_t *root)
{
    json_malloc_t get;
    json_free_t give;
    char *text, *safe;
    size_t n;

    json_get_alloc_funcs(&get, &give); /* which end the program, or succeed */
    text = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    n = text ? strlen(text) : 0;
    safe = text ? get(RAD_TEXT_JSON_ROOM(n)) : NULL;
    if (safe) {
        rad_text_json(text, n, safe);
        fprintf(to, "%s\n", safe);
    }
    give(safe);
    give(text);
}
