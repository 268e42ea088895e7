/* help.h - rows of a program's --help
 *
 * Thread: any.  */
#ifndef RAD_BASE_HELP_H
#define RAD_BASE_HELP_H

/* Call `line` for each line of a row, without line ends.  head is indented by
 * two; text begins in column RAD_HELP_COLUMN and is broken at RAD_HELP_WIDTH
 * columns.  A word that is wider has a line of its own. */
#define RAD_HELP_COLUMN 30
#define RAD_HELP_WIDTH  79
void rad_help_row(const char *head, const char *text,
                  void (*line)(void *arg, const char *text), void *arg);

#endif
