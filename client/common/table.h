/* table.h - JSON as a table
 *
 * Members of an object that are plain values become lines "name value".  A list
 * of objects becomes a table, with a column for each member of its first
 * object.  An object inside becomes a paragraph.  Values that need several
 * lines, such as a list inside a row, are only counted; --json has them.  Cells
 * are cut at 60 columns of the terminal, between characters; control characters
 * in foreign text are made harmless (base/text.h).
 * Thread: any. */
#ifndef RADD_CLIENT_TABLE_H
#define RADD_CLIENT_TABLE_H

#include <jansson.h>
#include <stdio.h>

/* Print root, an object or a list. */
void table_print(FILE *to, const json_t *root);

/* Print it as JSON, with control characters made harmless (base/text.h). */
void table_print_json(FILE *to, const json_t *root);

#endif
