/* log.c - see log.h */
#include "config.h"

#include "net/log.h"

#include "base/text.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define LINE_MAX_BYTES 2048

static const struct {
    const char *name;
    char priority; /* syslog(3)'s, for the journal */
} levels[] = {
    [LOG_LEVEL_ERR] = { "err", '3' },
    [LOG_LEVEL_WARN] = { "warn", '4' },
    [LOG_LEVEL_INFO] = { "info", '6' },
    [LOG_LEVEL_DEBUG] = { "debug", '7' },
};

static struct {
    const char *program; /* [fixed] after log_open() */
    bool journal;        /* [fixed] */
    _Atomic int level;   /* relaxed: a line more or less is harmless */
} logger = { "radd", false, LOG_LEVEL_INFO };

/* Is stderr a stream of the journal?  JOURNAL_STREAM alone does not tell, for a
 * program inherits it even if its stderr goes elsewhere (systemd.exec(5)). */
static bool
stderr_is_journal(void)
{
    const char *stream = getenv("JOURNAL_STREAM");
    unsigned long long device, inode;
    struct stat st;

    return stream && sscanf(stream, "%llu:%llu", &device, &inode) == 2 &&
           fstat(STDERR_FILENO, &st) == 0 && st.st_dev == device &&
           st.st_ino == inode;
}

void
log_open(const char *program, enum log_level level)
{
    logger.program = program;
    logger.journal = stderr_is_journal();
    tzset(); /* later the sandbox may not let us read the time zone's file */
    log_set_level(level);
}

void
log_set_level(enum log_level level)
{
    atomic_store_explicit(&logger.level, (int)level, memory_order_relaxed);
}

int
log_level_parse(const char *name)
{
    for (int i = 0; i < (int)(sizeof levels / sizeof levels[0]); i++)
        if (strcmp(name, levels[i].name) == 0)
            return i;
    return -1;
}

/* "2026-03-01T12:00:00.250+0100 " */
static size_t
put_time(char *buf, size_t size)
{
    struct timespec t;
    struct tm tm;
    size_t n;

    clock_gettime(CLOCK_REALTIME, &t);
    if (!localtime_r(&t.tv_sec, &tm))
        return 0;
    n = strftime(buf, size, "%Y-%m-%dT%H:%M:%S", &tm);
    n += (size_t)snprintf(buf + n, size - n, ".%03ld", t.tv_nsec / 1000000);
    return n + strftime(buf + n, size - n, "%z ", &tm);
}

static int
line_start(char *buf, size_t size, enum log_level level)
{
    size_t n;

    if (logger.journal)
        return snprintf(buf, size, "<%c>", levels[level].priority);
    n = put_time(buf, size);
    return (int)n + snprintf(buf + n, size - n, "%s[%ld] %s: ", logger.program,
                             (long)getpid(), levels[level].name);
}

void
log_at(enum log_level level, const char *fmt, ...)
{
    char line[LINE_MAX_BYTES];
    va_list ap;
    int n;
    size_t len;
    ssize_t ignored;

    if ((int)level > atomic_load_explicit(&logger.level, memory_order_relaxed))
        return;
    n = line_start(line, sizeof line, level);
    va_start(ap, fmt);
    rad_text_vprint(line + n, sizeof line - (size_t)n, fmt, ap);
    va_end(ap);
    rad_text_clean(line + n);
    len = strlen(line);
    line[len] = '\n';
    /* if stderr fails there is nowhere to report it */
    ignored = write(STDERR_FILENO, line, len + 1);
    (void)ignored;
}

bool
log_allowed(struct log_limit *l, uint64_t now_ms, unsigned *dropped)
{
    *dropped = 0;
    if (l->passed == 0 || now_ms - l->start_ms >= LOG_WINDOW_MS) {
        *dropped = l->dropped;
        l->start_ms = now_ms;
        l->passed = 0;
        l->dropped = 0;
    }
    if (l->passed >= LOG_BURST) {
        l->dropped++;
        return false;
    }
    l->passed++;
    return true;
}

_Noreturn void
log_out_of_memory(void)
{
    static const char text[] = "out of memory\n";

    if (write(STDERR_FILENO, text, sizeof text - 1) < 0)
        _exit(EX_IOERR);
    _exit(EX_OSERR);
}
