/* help.h - rows of a program's --help
 *
 * Thread: any.  */
#ifndef RAD_BASE_HELP_H
#define RAD_BASE_HELP_H

/* Give `line` the lines of a row, without their ends: head, indented by two,
 * and text from column RAD_HELP_COLUMN on, in as many lines of at most
 * RAD_HELP_WIDTH columns as it takes.  A word that is longer stands alone. */
#define RAD_HELP_COLUMN 30
#define RAD_HELP_WIDTH  79
void rad_help_row(const char *head, const char *text,
                  void (*line)(void *arg, const char *text), void *arg);

#endif
