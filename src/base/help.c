/* help.c - see help.h */
#include "config.h"

#include "base/help.h"

#include <stdio.h>
#include <string.h>

/* How many bytes of the text go on one line: whole words, at least one. */
static int
line_of(const char *text)
{
    const size_t room = RAD_HELP_WIDTH - RAD_HELP_COLUMN;
    size_t n = strlen(text), end = 0;

    if (n <= room)
        return (int)n;
    for (size_t i = 0; i <= room; i++)
        if (text[i] == ' ')
            end = i;
    return (int)(end > 0 ? end : strcspn(text, " "));
}

void
rad_help_row(const char *head, const char *text,
             void (*line)(void *arg, const char *text), void *arg)
{
    char buf[RAD_HELP_WIDTH + 400];

    snprintf(buf, sizeof buf, "  %s", head);
    if (strlen(buf) > RAD_HELP_COLUMN - 2) {
        line(arg, buf);
        buf[0] = '\0';
    }
    while (*text) {
        int n = line_of(text), used = (int)strlen(buf);

        snprintf(buf + used, sizeof buf - (size_t)used, "%*s%.*s",
                 RAD_HELP_COLUMN - used, "", n, text);
        line(arg, buf);
        text += n;
        text += strspn(text, " ");
        buf[0] = '\0';
    }
    if (buf[0]) /* no text */
        line(arg, buf);
}
