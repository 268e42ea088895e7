/* error.h - codes and messages of everything that can fail
 *
 * Fallible functions return 0 or a negative code and take a struct rad_error *
 * last, which may be NULL.  The first failure wins: a later rad_fail() on the
 * same struct changes nothing.  So callers may fill an empty `where` and pass
 * the code up.  Our codes lie below libuv's, so one int holds either.
 * Libraries never print and never exit; main prints once (rad_error_format)
 * and exits with rad_exit_status().
 * Thread: a struct rad_error belongs to one thread.  */
#ifndef RAD_BASE_ERROR_H
#define RAD_BASE_ERROR_H

#include <stddef.h>

enum rad_code {
    RAD_EUSAGE = -5001,       /* wrong command line               EX_USAGE 64 */
    RAD_EDATA = -5002,        /* bad scene, picture or data     EX_DATAERR 65 */
    RAD_ENOINPUT = -5003,     /* input missing or unreadable    EX_NOINPUT 66 */
    RAD_EUNAVAIL = -5004,     /* no coordinator or worker in time          69 */
    RAD_EINTERNAL = -5005,    /* our bug                       EX_SOFTWARE 70 */
    RAD_ENOMEM = -5006,       /* out of memory                    EX_OSERR 71 */
    RAD_ECANTCREAT = -5007,   /* output cannot be created     EX_CANTCREAT 73 */
    RAD_EIO = -5008,          /* read or write failed             EX_IOERR 74 */
    RAD_ETEMPFAIL = -5009,    /* try again later               EX_TEMPFAIL 75 */
    RAD_EPROTO = -5010,       /* bytes against the protocol    EX_PROTOCOL 76 */
    RAD_EPERM = -5011,        /* not permitted                   EX_NOPERM 77 */
    RAD_ECONFIG = -5012,      /* bad configuration file          EX_CONFIG 78 */
    RAD_EUNSUPPORTED = -5013, /* Radiance's, but not ours                  65 */
    RAD_EFULL = -5014,        /* no room on the disk              EX_IOERR 74 */
    RAD_ESHORT = -5015,       /* out of descriptors, threads, for now      75 */
    RAD_WARNING = -5099       /* marks a warning for callers that want every
                               * problem; never the code of a failure */
};

struct rad_error {
    int code;       /* RAD_E* or UV_E*; 0 until something fails */
    char where[256]; /* "office.rad:214", "ws3:7421", or empty */
    char what[256]; /* "undefined modifier 'wood'" */
};

/* Record the first failure and return its code: `return rad_fail(...)`.
 * err may be NULL.  The message is lower case without a full stop, says the
 * problem first and quotes the subject. */
int rad_fail(struct rad_error *err, int code, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with RAD_ENOMEM: "out of memory". */
int rad_fail_memory(struct rad_error *err);

/* Set `where` if it is still empty; for callers that pass a failure up. */
void rad_error_where(struct rad_error *err, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/* Put "where: what", or just what, into buf.  The text is terminated, and safe
 * for a terminal or a log even if it quotes input (text.h). */
void rad_error_format(const struct rad_error *err, char *buf, size_t size);

/* The sysexits.h status for a code: 0 for 0, EX_SOFTWARE (70) for codes that
 * are not ours. */
int rad_exit_status(int code);

#endif
