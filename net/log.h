/* log.h - the daemons' log: one event a line on stderr
 *
 * An event is a few fixed words, then key=value pairs:
 *     bar done job=17 y=428 rows=4 peer=ws3 ms=812
 * Text that came from outside can break neither the format nor the terminal:
 * what is unsafe there (base/text.h) becomes '?'.  Where stderr is systemd's
 * journal (JOURNAL_STREAM names it) lines start with the journal's priority,
 * elsewhere with the local time, the program's name and the level.
 * Thread: any; a line is one write(2).  log_open() before other threads. */
#ifndef RADD_NET_LOG_H
#define RADD_NET_LOG_H

#include <stdbool.h>
#include <stdint.h>

enum log_level {
    LOG_LEVEL_ERR,
    LOG_LEVEL_WARN,
    LOG_LEVEL_INFO,
    LOG_LEVEL_DEBUG
};

/* program must outlive the log. */
void log_open(const char *program, enum log_level level);
void log_set_level(enum log_level level);

/* "err", "warn", "info" or "debug"; negative: another word. */
int log_level_parse(const char *name);

void log_at(enum log_level level, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

#define log_err(...)   log_at(LOG_LEVEL_ERR, __VA_ARGS__)
#define log_warn(...)  log_at(LOG_LEVEL_WARN, __VA_ARGS__)
#define log_info(...)  log_at(LOG_LEVEL_INFO, __VA_ARGS__)
#define log_debug(...) log_at(LOG_LEVEL_DEBUG, __VA_ARGS__)

/* Limits log lines of an event that others can cause: at most LOG_BURST lines
 * in LOG_WINDOW_MS.  Begins zeroed. */
#define LOG_BURST     10
#define LOG_WINDOW_MS 10000
struct log_limit {
    uint64_t start_ms;
    unsigned passed, dropped;
};

/* May this event be logged at now_ms?  If so, *dropped is the number of lines
 * that were kept back in the window before. */
bool log_allowed(struct log_limit *l, uint64_t now_ms, unsigned *dropped);

/* End the process at once with EX_OSERR, if memory is out where a failure
 * cannot be handled.  Nothing that was acknowledged is lost. */
_Noreturn void log_out_of_memory(void);

#endif
