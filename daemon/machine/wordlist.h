/* wordlist.h - a text of words as JSON
 *
 * Thread: any. */
#ifndef DAEMON_WORDLIST_H
#define DAEMON_WORDLIST_H

#include <jansson.h>

/* The words of a text, with blanks between them, as an array of strings; NULL
 * when memory is out. */
json_t *wordlist_json(const char *text);

#endif
