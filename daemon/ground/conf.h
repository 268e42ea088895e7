/* conf.h - settings of a daemon, from its file and its command line
 *
 * A daemon has one table of settings.  Each row is a key of the INI file and
 * a --long-option of the same meaning (cache_mib and --cache-mib).  Defaults
 * come first, then the file, then the options.
 * The file's keys stand in no section or in one called as the program.
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
    CONF_BOOL_KEY  /* bool; as an option it may do without a value */
};

struct conf_key {
    const char *name; /* as in the file: lower case, '_' between words */
    enum conf_kind kind;
    size_t offset;   /* of the field in the daemon's settings struct */
    int min, max;    /* of an integer */
    const char *def; /* default, as the file would say it */
    const char *arg; /* what the help calls the value; NULL: hidden key,
                      * an option that the file may not set */
    const char *help;
    bool reload; /* taken over on SIGHUP */
};

struct conf_table {
    const char *program;
    const char *synopsis;        /* after the program's name, in the help */
    const char *about;           /* what it does, for the help; or NULL */
    const char *file;            /* default file; need not exist */
    const char *private_key;     /* with this option the default file is not
                                  * read */
    const struct conf_key *keys; /* ends with name == NULL */
    size_t size;                 /* of the settings struct */
    /* Is this text one for that key?  For what a bad one can be told by
     * itself, so that the error names its line; or NULL. */
    int (*check_text)(const char *name, const char *value,
                      struct rad_error *err);
    /* Do the settings go together?  Or NULL. */
    int (*check)(const void *settings, struct rad_error *err);
};

enum conf_wish { CONF_RUN, CONF_HELP, CONF_VERSION };

/* Defaults into settings. */
void conf_defaults(const struct conf_table *t, void *settings);

/* Read the file at path over *settings.  RAD_ENOINPUT if it cannot be opened,
 * RAD_ECONFIG with file and line for what is wrong in it. */
int conf_read(const struct conf_table *t, void *settings, const char *path,
              struct rad_error *err);

/* All of it: defaults, file (--config=FILE, else t->file if it is there),
 * options, t->check.  Returns an enum conf_wish or a negative code:
 * RAD_EUSAGE for a wrong command line, RAD_ECONFIG for the file, also where the
 * options alone would do.  argv stays in order. */
int conf_load(const struct conf_table *t, void *settings, int argc,
              char *argv[], struct rad_error *err);

/* Read the file again, over the same command line; only keys marked reload
 * change in *settings.  *loaded is what conf_load() gave, kept apart because a
 * daemon fills in what was left to it; it follows what is taken over.  The
 * names of changed keys that want a restart go to `later`, with a comma
 * between, cut where they do not fit; "" if there are none. */
int conf_reload(const struct conf_table *t, void *settings, void *loaded,
                int argc, char *argv[], char later[CONF_TEXT],
                struct rad_error *err);

/* --help and --version onto stdout. */
void conf_help(const struct conf_table *t);
void conf_version(const struct conf_table *t);

#endif
