/* table.c - see table.h */
#include "config.h"

#include "table.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CELL = 64 /* longest text of a cell, with its NUL */ };

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

/* A value in one line; what comes from others keeps off the terminal's
 * controls. */
static void
format_cell(char cell[CELL], const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_STRING:
        snprintf(cell, CELL, "%s",
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
    for (char *p = cell; *p; p++)
        if ((unsigned char)*p < ' ' || *p == 0x7f)
            *p = '?';
}

/* The column's width on the screen, counting UTF-8's bytes that continue as
 * nothing. */
static size_t
width_of(const char *s)
{
    size_t n = 0;

    for (; *s; s++)
        n += ((unsigned char)*s & 0xc0) != 0x80;
    return n;
}

static void
put_cell(FILE *to, const char *cell, size_t width, bool right, bool last)
{
    size_t n = width_of(cell);
    int pad = n < width ? (int)(width - n) : 0;

    if (right)
        fprintf(to, "%*s%s", pad, "", cell);
    else
        fprintf(to, "%s%*s", cell, last ? 0 : pad, "");
    fputs(last ? "\n" : "  ", to);
}

/* The widest cell of a column, its head included. */
static size_t
column_width(const json_t *rows, const char *key)
{
    size_t i, width = width_of(key);
    const json_t *row, *value;
    char cell[CELL];

    json_array_foreach(rows, i, row)
    {
        value = json_object_get(row, key);
        if (value) {
            format_cell(cell, value);
            if (width_of(cell) > width)
                width = width_of(cell);
        }
    }
    return width;
}

static void
put_row(FILE *to, const json_t *rows, const json_t *row, bool head)
{
    json_t *first = json_array_get(rows, 0);
    size_t k = 0, n = json_object_size(first);
    const char *key;
    const json_t *shown, *value;
    char cell[CELL];

    json_object_foreach(first, key, shown)
    {
        value = head ? NULL : json_object_get(row, key);
        if (head)
            snprintf(cell, sizeof cell, "%s", key);
        else if (value)
            format_cell(cell, value);
        else
            strcpy(cell, "-");
        put_cell(to, cell, column_width(rows, key), json_is_number(shown),
                 ++k == n);
    }
}

static void
print_rows(FILE *to, const char *name, const json_t *rows, size_t most)
{
    size_t i, n = json_array_size(rows);
    const json_t *row;

    if (n == 0) {
        fprintf(to, "no %s\n", name);
        return;
    }
    if (n > most || !json_is_object(json_array_get(rows, 0))) {
        fprintf(to, "%s: %zu\n", name, n);
        return;
    }
    put_row(to, rows, NULL, true);
    json_array_foreach(rows, i, row) put_row(to, rows, row, false);
}

/* The plain members of an object, their names in a column. */
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
        if (json_is_string(value)) { /* whole, however long */
            fprintf(to, "%-*s  ", (int)width, key);
            for (const char *p = json_string_value(value); *p; p++)
                fputc((unsigned char)*p < ' ' || *p == 0x7f ? '?' : *p, to);
            fputc('\n', to);
            continue;
        }
        format_cell(cell, value);
        fprintf(to, "%-*s  %s\n", (int)width, key, cell);
    }
    return any;
}

void
table_print(FILE *to, const json_t *root, size_t most)
{
    const char *key;
    json_t *value;
    bool above;

    if (json_is_array(root)) {
        print_rows(to, "entries", root, most);
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
            print_rows(to, key, value, most);
        } else {
            fprintf(to, "%s\n", key);
            print_plain(to, value);
        }
    }
}
