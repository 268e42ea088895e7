/* conf.h - settings of a daemon, from its file and its command line
 *
 * A daemon has one table of settings.  Each row is a key of the INI file and
 * a --long-option of the same meaning (cache_mib and --cache-mib).  Defaults
 * come first, then the file, then the options.
 * The file's keys stand in no section, or in the section [PROGRAM].
 * Thread: main's, and the loop's on reload. */
#ifndef RADD_DAEMON_CONF_H
#define RADD_DAEMON_CONF_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

#define CONF_TEXT 1024 /* longest text or path, with its NUL */

enum conf_kind {
    CONF_TEXT_KEY, /* char[CONF_TEXT] */
    CONF_INT_KEY,  /* int, min..max */
    CONF_BOOL_KEY  /* bool; an option without a value means yes */
};

struct conf_key {
    const char *name; /* as in the file: lower case, '_' between words */
    enum conf_kind kind;
    size_t offset;   /* of the field in the daemon's settings struct */
    int min, max;    /* for CONF_INT_KEY */
    const char *def; /* default, as the file would say it */
    const char *arg; /* the value's name in the help; NULL: an option that the
                      * help hides, and that the file may not set */
    const char *help;
    bool reload; /* SIGHUP takes a new value over */
};

struct conf_table {
    const char *program;
    const char *synopsis;        /* after the program's name, in the help */
    const char *about;           /* the program's task, for the help; or NULL */
    const char *file;            /* default file; need not exist */
    const char *private_key;     /* with this option the default file is not
                                  * read */
    const struct conf_key *keys; /* ends with name == NULL */
    size_t size;                 /* of the settings struct */
    /* Check one text by itself, so that the error can name its line; or NULL.
     */
    int (*check_text)(const char *name, const char *value,
                      struct rad_error *err);
    /* Check that the settings go together; or NULL. */
    int (*check)(const void *settings, struct rad_error *err);
};

enum conf_wish { CONF_RUN, CONF_HELP, CONF_VERSION };

/* Set *settings to the defaults. */
void conf_defaults(const struct conf_table *t, void *settings);

/* Read the file at path over *settings.  RAD_ENOINPUT if the file cannot be
 * opened, RAD_ECONFIG with file and line for an error in it. */
int conf_read(const struct conf_table *t, void *settings, const char *path,
              struct rad_error *err);

/* Set *settings from defaults, file and options, and check them (t->check).
 * The file is --config=FILE, else t->file if that exists.  Returns an enum
 * conf_wish or a negative code: RAD_EUSAGE for a wrong command line,
 * RAD_ENOINPUT, RAD_EPERM and RAD_ECONFIG for the file, RAD_ECONFIG also if
 * t->check refuses the settings, but not the options alone.  argv stays in
 * order. */
int conf_load(const struct conf_table *t, void *settings, int argc,
              char *argv[], struct rad_error *err);

/* Load the settings again; only keys marked reload change in *settings and
 * *loaded.  *loaded has the settings as conf_load() set them, for a daemon may
 * fill in some of *settings itself.  `later` gets the names of changed keys
 * that need a restart, with commas between, cut where they do not fit; "" if
 * there are none.  After an error nothing is changed. */
int conf_reload(const struct conf_table *t, void *settings, void *loaded,
                int argc, char *argv[], char later[CONF_TEXT],
                struct rad_error *err);

/* --help and --version onto stdout. */
void conf_help(const struct conf_table *t);
void conf_version(const struct conf_table *t);

#endif
