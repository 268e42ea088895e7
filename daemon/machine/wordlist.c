/* wordlist.c - see wordlist.h */
#include "config.h"

#include "machine/wordlist.h"

#include <string.h>

json_t *
wordlist_json(const char *text)
{
    json_t *list = json_array();

    while (*text) {
        size_t n = strcspn(text, " ");

        if (n > 0)
            json_array_append_new(list, json_stringn(text, n));
        text += n + (text[n] == ' ');
    }
    return list;
}
