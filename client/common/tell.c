/* tell.c - see tell.h */
#include "config.h"

#include "common/tell.h"

#include "base/text.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

void
tell(FILE *to, const char *fmt, ...)
{
    char line[8192];
    va_list ap;

    va_start(ap, fmt);
    rad_text_vprint(line, sizeof line, fmt, ap);
    va_end(ap);
    rad_text_clean(line);
    fprintf(to, "%s\n", line);
}

void
tell_line(void *to, const char *text)
{
    fprintf(to, "%s\n", text);
}

int
tell_printed(struct rad_error *err)
{
    errno = 0; /* ferror() does not tell which error a failed write had */
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    return rad_fail(err, RAD_EIO, "cannot write%s%s", errno ? ": " : "",
                    errno ? strerror(errno) : "");
}
