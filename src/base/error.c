/* error.c - see error.h */
#include "config.h"

#include "base/error.h"
#include "base/text.h"

#include <stdarg.h>
#include <string.h>
#include <sysexits.h>

/* vsnprintf() for text with long paths: if it does not fit, its middle is left
 * out, because the end names the line or the reason. */
static void
print_ends(char *buf, size_t size, const char *fmt, va_list ap)
{
    static const char gap[] = "...";
    char all[8192];
    size_t n, head = size / 3, tail = size - head - sizeof gap;

    rad_text_vprint(all, sizeof all, fmt, ap);
    n = strlen(all);
    if (n < size) {
        memcpy(buf, all, n + 1);
        return;
    }
    rad_text_print(buf, head + 1, "%s", all);
    while (tail > 0 && (all[n - tail] & 0xc0) == 0x80)
        tail--; /* do not begin inside a character */
    rad_text_print(buf + strlen(buf), size - strlen(buf), "%s%s", gap,
                   all + n - tail);
}

int
rad_fail(struct rad_error *err, int code, const char *fmt, ...)
{
    if (err && err->code == 0) {
        va_list ap;

        err->code = code;
        va_start(ap, fmt);
        print_ends(err->what, sizeof err->what, fmt, ap);
        va_end(ap);
    }
    return code;
}

int
rad_fail_memory(struct rad_error *err)
{
    return rad_fail(err, RAD_ENOMEM, "out of memory");
}

void
rad_error_where(struct rad_error *err, const char *fmt, ...)
{
    if (err && err->where[0] == '\0') {
        va_list ap;

        va_start(ap, fmt);
        print_ends(err->where, sizeof err->where, fmt, ap);
        va_end(ap);
    }
}

void
rad_error_format(const struct rad_error *err, char *buf, size_t size)
{
    if (size == 0)
        return;
    if (err->where[0])
        rad_text_print(buf, size, "%s: %s", err->where, err->what);
    else
        rad_text_print(buf, size, "%s", err->what);
    rad_text_clean(buf);
}

int
rad_exit_status(int code)
{
    switch (code) {
    case 0:
        return EX_OK;
    case RAD_EUSAGE:
        return EX_USAGE;
    case RAD_EDATA:
    case RAD_EUNSUPPORTED:
        return EX_DATAERR;
    case RAD_ENOINPUT:
        return EX_NOINPUT;
    case RAD_EUNAVAIL:
        return EX_UNAVAILABLE;
    case RAD_ENOMEM:
        return EX_OSERR;
    case RAD_ECANTCREAT:
        return EX_CANTCREAT;
    case RAD_EIO:
    case RAD_EFULL:
        return EX_IOERR;
    case RAD_ETEMPFAIL:
    case RAD_ESHORT:
        return EX_TEMPFAIL;
    case RAD_EPROTO:
        return EX_PROTOCOL;
    case RAD_EPERM:
        return EX_NOPERM;
    case RAD_ECONFIG:
        return EX_CONFIG;
    default:
        return EX_SOFTWARE;
    }
}
