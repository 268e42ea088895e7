/* log.c - see log.h */
#include "config.h"

#include "log.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LINE_MAX_BYTES 2048

static const struct {
    const char *name;
    char priority; /* syslog(3)'s, as the journal reads it */
} levels[] = {
    [LOG_LEVEL_ERR] = { "err", '3' },
    [LOG_LEVEL_WARN] = { "warn", '4' },
    [LOG_LEVEL_INFO] = { "info", '6' },
    [LOG_LEVEL_DEBUG] = { "debug", '7' },
};

static struct {
    const char *program; /* [fixed] after log_open() */
    bool journal;        /* [fixed] */
    _Atomic int level;   /* relaxed: a line more or less does not matter */
} logger = { "radd", false, LOG_LEVEL_INFO };

void
log_open(const char *program, enum log_level level)
{
    logger.program = program;
    logger.journal = getenv("JOURNAL_STREAM") != NULL;
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

static int
line_start(char *buf, size_t size, enum log_level level)
{
    if (logger.journal)
        return snprintf(buf, size, "<%c>", levels[level].priority);
    return snprintf(buf, size, "%s[%ld] %s: ", logger.program, (long)getpid(),
                    levels[level].name);
}

void
log_at(enum log_level level, const char *fmt, ...)
{
    char line[LINE_MAX_BYTES];
    va_list ap;
    int n, m;
    ssize_t ignored;

    if ((int)level > atomic_load_explicit(&logger.level, memory_order_relaxed))
        return;
    n = line_start(line, sizeof line, level);
    va_start(ap, fmt);
    m = vsnprintf(line + n, sizeof line - (size_t)n, fmt, ap);
    va_end(ap);
    if (m < 0)
        return;
    n += m;
    if (n > (int)sizeof line - 1)
        n = (int)sizeof line - 1;
    for (int i = 0; i < n; i++)
        if ((unsigned char)line[i] < ' ' || line[i] == 0x7f)
            line[i] = '?';
    line[n] = '\n';
    /* nobody is left to tell if stderr is gone */
    ignored = write(STDERR_FILENO, line, (size_t)n + 1);
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
