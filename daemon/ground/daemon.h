/* daemon.h - what both daemons do to start, to live and to end
 *
 * Settings, log, loop, tick, signals, reload, the pipe of an embedded cluster,
 * and messages to systemd.
 * Thread: main's. */
#ifndef RADD_DAEMON_DAEMON_H
#define RADD_DAEMON_DAEMON_H

#include "ground/conf.h"
#include "ground/service.h"

#include <stddef.h>
#include <uv.h>

/* First in each daemon's settings. */
struct daemon_settings {
    char ports_file[CONF_TEXT];
    char log_level[CONF_TEXT];
    bool embedded;   /* in a cluster of radsubmit's own: never wait for the
                      * disk */
    int lifetime_fd; /* a pipe: end when the process at its other end does;
                      * -1: none */
};

/* Rows of these settings, last in each daemon's table. */
#define DAEMON_FIELD(f) offsetof(struct daemon_settings, f)
#define DAEMON_KEYS                                                            \
    { "ports_file",                                                            \
      CONF_TEXT_KEY,                                                           \
      DAEMON_FIELD(ports_file),                                                \
      0,                                                                       \
      0,                                                                       \
      "",                                                                      \
      "FILE",                                                                  \
      "gets the sockets in use, one a line",                                   \
      false },                                                                 \
        { "log_level", CONF_TEXT_KEY, DAEMON_FIELD(log_level),    0,   0,      \
          "info",      "LEVEL",       "err, warn, info or debug", true },      \
        { "embedded", CONF_BOOL_KEY, DAEMON_FIELD(embedded), 0, 0, "no", NULL, \
          NULL,       false },                                                 \
        { "lifetime_fd",                                                       \
          CONF_INT_KEY,                                                        \
          DAEMON_FIELD(lifetime_fd),                                           \
          -1,                                                                  \
          1 << 20,                                                             \
          "-1",                                                                \
          NULL,                                                                \
          NULL,                                                                \
          false },                                                             \
    {                                                                          \
        NULL, 0, 0, 0, 0, NULL, NULL, NULL, false                              \
    }

struct daemon_ops {
    /* Open all that the daemon serves with; an error ends the daemon. */
    int (*start)(void *arg, struct rad_error *err);
    void (*tick)(void *arg); /* every DAEMON_TICK_MS */
    void (*term)(void *arg); /* the first SIGTERM or SIGINT, and later ones
                              * until daemon_stop() */
    void (*reloaded)(void *arg);
    /* Close all that is open, and wait until nothing is left to do. */
    void (*finish)(void *arg);
    /* Free the daemon's memory; called after finish(). */
    void (*release)(void *arg);
};
#define DAEMON_TICK_MS 100

/* 2026: a system's clock that shows less [ms] is wrong. */
#define DAEMON_RIGHT_MS UINT64_C(1767225600000)

struct daemon {
    const struct conf_table *table;
    struct daemon_settings *set;
    void *loaded; /* the settings as conf_load() set them, see conf_reload() */
    const struct daemon_ops *ops;
    void *arg;
    int argc;
    char **argv;
    uv_loop_t loop;
    uv_work_t first_work; /* see threads.h */
    uv_timer_t ticker;
    uv_signal_t sigterm, sigint, sighup;
    struct service_lifetime lifetime;
    int notify;           /* systemd's socket; -1: none */
    uint64_t watchdog_ms; /* systemd waits so long for a sign of life; 0: not */
    uint64_t fed_ms;      /* when systemd got the last sign of life */
    bool stopping;
    int status;
};

/* Check a text that both daemons have (conf_table.check_text). */
int daemon_check_text(const char *name, const char *value,
                      struct rad_error *err);

/* Run the daemon from start to end; the caller has set table, set, ops and arg.
 * Returns the exit status. */
int daemon_run(struct daemon *d, int argc, char *argv[]);

/* End the daemon with that exit status; only the first call counts. */
void daemon_stop(struct daemon *d, int status);

/* The loop's time [ms]. */
uint64_t daemon_now(const struct daemon *d);

#endif
