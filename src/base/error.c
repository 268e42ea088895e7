/* error.c - see error.h */
#include "config.h"

#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <sysexits.h>

int
rad_fail(struct rad_error *err, int code, const char *fmt, ...)
{
    if (err && err->code == 0) {
        va_list ap;

        err->code = code;
        va_start(ap, fmt);
        vsnprintf(err->what, sizeof err->what, fmt, ap);
        va_end(ap);
    }
    return code;
}

void
rad_error_where(struct rad_error *err, const char *fmt, ...)
{
    if (err && err->where[0] == '\0') {
        va_list ap;

        va_start(ap, fmt);
        vsnprintf(err->where, sizeof err->where, fmt, ap);
        va_end(ap);
    }
}

void
rad_error_format(const struct rad_error *err, char *buf, size_t size)
{
    if (size == 0)
        return;
    if (err->where[0])
        snprintf(buf, size, "%s: %s", err->where, err->what);
    else
        snprintf(buf, size, "%s", err->what);
    for (char *p = buf; *p; p++)
        if ((unsigned char)*p < ' ' || *p == 0x7f)
            *p = '?';
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
