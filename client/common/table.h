/* table.h - JSON objects as people read them
 *
 * An object's plain members are lines "name  value"; a list of objects is a
 * table, its columns the members of the first one; an object inside is a
 * paragraph of its own.  What needs more than a line (a list inside a table's
 * row) is left to --json.  Cells are cut between characters, at 60 columns of
 * a terminal; what comes from others keeps off its controls (base/text.h).
 * Thread: any.  */
#ifndef RADD_CLIENT_TABLE_H
#define RADD_CLIENT_TABLE_H

#include <jansson.h>
#include <stdio.h>

/* root is an object or a list. */
void table_print(FILE *to, const json_t *root);

/* As a program reads it; a terminal obeys nothing in it (base/text.h). */
void table_print_json(FILE *to, const json_t *root);

#endif
