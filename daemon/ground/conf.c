/* conf.c - see conf.h */
#include "config.h"

#include "ground/conf.h"

#include "base/help.h"
#include "base/number.h"
#include "net/inifile.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define MAX_KEYS 48

/* options that are no keys, as getopt_long's values above any key's index */
enum { OPT_CONFIG = 1000, OPT_HELP, OPT_VERSION };

static int
parse_int(const struct conf_key *k, const char *value, int *out,
          struct rad_error *err)
{
    int v;

    if (!rad_parse_int(value, &v))
        return rad_fail(err, RAD_ECONFIG, "'%s': bad number '%s'", k->name,
                        value);
    if (v < k->min || v > k->max)
        return rad_fail(err, RAD_ECONFIG, "'%s': %d is not within %d to %d",
                        k->name, v, k->min, k->max);
    *out = v;
    return 0;
}

static int
parse_bool(const struct conf_key *k, const char *value, bool *out,
           struct rad_error *err)
{
    if (strcmp(value, "yes") == 0 || strcmp(value, "true") == 0) {
        *out = true;
        return 0;
    }
    if (strcmp(value, "no") == 0 || strcmp(value, "false") == 0) {
        *out = false;
        return 0;
    }
    return rad_fail(err, RAD_ECONFIG, "'%s': expected yes or no, got '%s'",
                    k->name, value);
}

/* Fail with RAD_ECONFIG and the key's name if the text is too long, or the
 * table refuses it. */
static int
check_text(const struct conf_table *t, const struct conf_key *k,
           const char *value, struct rad_error *err)
{
    struct rad_error why = { 0 };

    if (strlen(value) >= CONF_TEXT)
        return rad_fail(err, RAD_ECONFIG, "'%s': value longer than %d", k->name,
                        CONF_TEXT - 1);
    if (!t->check_text || t->check_text(k->name, value, &why) >= 0)
        return 0;
    return rad_fail(err, RAD_ECONFIG, "'%s': %s", k->name, why.what);
}

static int
set_key(const struct conf_table *t, const struct conf_key *k, void *settings,
        const char *value, struct rad_error *err)
{
    char *field = (char *)settings + k->offset;
    int rc;

    switch (k->kind) {
    case CONF_INT_KEY:
        return parse_int(k, value, (int *)(void *)field, err);
    case CONF_BOOL_KEY:
        return parse_bool(k, value, (bool *)(void *)field, err);
    case CONF_TEXT_KEY:
        if ((rc = check_text(t, k, value, err)) == 0)
            strcpy(field, value);
        return rc;
    }
    return rad_fail(err, RAD_EINTERNAL, "'%s': no such kind", k->name);
}

void
conf_defaults(const struct conf_table *t, void *settings)
{
    memset(settings, 0, t->size);
    for (const struct conf_key *k = t->keys; k->name; k++)
        if (k->def)
            set_key(t, k, settings, k->def, NULL);
}

/* Set a key that the file names.  RAD_ECONFIG: the key is unknown, or its value
 * is bad. */
static int
set_named(const struct conf_table *t, void *settings, const char *name,
          const char *value, struct rad_error *err)
{
    for (const struct conf_key *k = t->keys; k->name; k++)
        if (k->arg && strcmp(k->name, name) == 0)
            return set_key(t, k, settings, value, err);
    return rad_fail(err, RAD_ECONFIG, "unknown key '%s'", name);
}

struct filling {
    const struct conf_table *table;
    void *settings;
    bool set[MAX_KEYS]; /* keys that the file has set so far */
};

/* Refuse a key that the file sets twice. */
static int
note_set(struct filling *f, const char *name, struct rad_error *err)
{
    const struct conf_key *keys = f->table->keys;

    for (int i = 0; keys[i].name && i < MAX_KEYS; i++) {
        if (strcmp(keys[i].name, name) != 0)
            continue;
        if (f->set[i])
            return rad_fail(err, RAD_ECONFIG, "'%s' is there twice", name);
        f->set[i] = true;
    }
    return 0;
}

static int
take_pair(void *arg, const char *section, const char *name, const char *value,
          struct rad_error *err)
{
    struct filling *f = arg;
    int rc;

    if (section[0] && strcmp(section, f->table->program) != 0)
        return rad_fail(err, RAD_ECONFIG, "unknown section '%s'", section);
    rc = note_set(f, name, err);
    return rc < 0 ? rc : set_named(f->table, f->settings, name, value, err);
}

int
conf_read(const struct conf_table *t, void *settings, const char *path,
          struct rad_error *err)
{
    struct filling f = { .table = t, .settings = settings };
    FILE *file = fopen(path, "re");
    int rc;

    if (!file)
        return rad_fail(err, errno == EACCES ? RAD_EPERM : RAD_ENOINPUT,
                        "cannot open '%s': %s", path, strerror(errno));
    rc = inifile_read(file, path, take_pair, &f, err);
    fclose(file);
    return rc;
}

/* The command line as getopt_long knows it: a row per key. */
struct options {
    struct option rows[MAX_KEYS + 4];
    char names[MAX_KEYS][32];
};

static void
make_options(const struct conf_table *t, struct options *o)
{
    static const struct option fixed[] = {
        { "config", required_argument, NULL, OPT_CONFIG },
        { "help", no_argument, NULL, OPT_HELP },
        { "version", no_argument, NULL, OPT_VERSION },
        { NULL, 0, NULL, 0 },
    };
    int n = 0;

    for (const struct conf_key *k = t->keys; k->name && n < MAX_KEYS; k++) {
        snprintf(o->names[n], sizeof o->names[n], "%s", k->name);
        for (char *p = o->names[n]; *p; p++)
            if (*p == '_')
                *p = '-';
        o->rows[n].name = o->names[n];
        o->rows[n].has_arg =
            k->kind == CONF_BOOL_KEY ? optional_argument : required_argument;
        o->rows[n].flag = NULL;
        o->rows[n].val = n;
        n++;
    }
    memcpy(o->rows + n, fixed, sizeof fixed);
}

/* Return the next option as getopt_long() does, and its word: in a word of
 * several letters (-xy) optind does not go on before the last of them. */
static int
next_option(int argc, char *argv[], const struct options *o, const char **word)
{
    *word = argv[optind > 0 ? optind : 1];
    return getopt_long(argc, argv, "+:", o->rows, NULL);
}

/* Walk the command line once.  With settings NULL no key is set, and the
 * private key sets *config to "", unless --config names a file. */
static int
walk_options(const struct conf_table *t, void *settings, int argc, char *argv[],
             const char **config, struct rad_error *err)
{
    struct options o;
    const char *word;
    int c, wish = CONF_RUN, rc = 0;

    make_options(t, &o);
    opterr = 0;
    optind = 0; /* start anew: glibc's way */
    while (rc == 0 && (c = next_option(argc, argv, &o, &word)) != -1) {
        if (c == OPT_CONFIG)
            *config = optarg;
        else if (c == OPT_HELP)
            wish = CONF_HELP;
        else if (c == OPT_VERSION)
            wish = CONF_VERSION;
        else if (c == ':')
            rc = rad_fail(err, RAD_EUSAGE, "option '%s' needs a value", word);
        else if (c == '?')
            rc = rad_fail(err, RAD_EUSAGE, "unknown or ambiguous option '%s'",
                          word);
        else if (!settings && t->private_key &&
                 strcmp(t->keys[c].name, t->private_key) == 0)
            *config = *config ? *config : "";
        else if (settings)
            rc = set_key(t, &t->keys[c], settings, optarg ? optarg : "yes",
                         err);
    }
    if (rc == 0 && optind < argc)
        rc =
            rad_fail(err, RAD_EUSAGE, "unexpected argument '%s'", argv[optind]);
    return rc < 0 ? rc : wish;
}

/* Give the error another code, and return that. */
static int
recode(struct rad_error *err, int code)
{
    if (err)
        err->code = code;
    return code;
}

/* Set the defaults, the file's keys unless config is NULL, then the options. */
static int
load_all(const struct conf_table *t, void *settings, const char *config,
         int argc, char *argv[], struct rad_error *err)
{
    int rc;

    conf_defaults(t, settings);
    if (config && (rc = conf_read(t, settings, config, err)) < 0)
        return rc;
    rc = walk_options(t, settings, argc, argv, &config, err);
    /* the bad value is an option's, not the file's */
    return rc == RAD_ECONFIG ? recode(err, RAD_EUSAGE) : rc;
}

/* Are the options valid settings without the file? */
static bool
options_suffice(const struct conf_table *t, int argc, char *argv[])
{
    void *alone = malloc(t->size);
    bool fine = alone &&
                load_all(t, alone, NULL, argc, argv, NULL) == CONF_RUN &&
                t->check(alone, NULL) >= 0;

    free(alone);
    return fine;
}

/* Is there such a file, or something that only looking into it will tell?  A
 * file that this user may not read holds settings all the same. */
static bool
is_there(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 || (errno != ENOENT && errno != ENOTDIR);
}

int
conf_load(const struct conf_table *t, void *settings, int argc, char *argv[],
          struct rad_error *err)
{
    const char *config = NULL;
    int rc;

    conf_defaults(t, settings);
    rc = walk_options(t, NULL, argc, argv, &config, err);
    if (rc != CONF_RUN)
        return rc;
    if (!config && t->file && is_there(t->file))
        config = t->file;
    if (config && !config[0])
        config = NULL;
    rc = load_all(t, settings, config, argc, argv, err);
    if (rc != CONF_RUN || !t->check || (rc = t->check(settings, err)) >= 0)
        return rc;
    if (!config || !options_suffice(t, argc, argv))
        return rc;
    rad_error_where(err, "%s", config);
    return recode(err, RAD_ECONFIG);
}

static size_t
field_size(enum conf_kind kind)
{
    return kind == CONF_TEXT_KEY  ? CONF_TEXT
           : kind == CONF_INT_KEY ? sizeof(int)
                                  : sizeof(bool);
}

static bool
same_field(const struct conf_key *k, const void *a, const void *b)
{
    const char *p = (const char *)a + k->offset;
    const char *q = (const char *)b + k->offset;

    return k->kind == CONF_TEXT_KEY ? strcmp(p, q) == 0
                                    : memcmp(p, q, field_size(k->kind)) == 0;
}

static void
copy_field(const struct conf_key *k, void *to, const void *from)
{
    memcpy((char *)to + k->offset, (const char *)from + k->offset,
           field_size(k->kind));
}

static void
add_name(char list[CONF_TEXT], const char *name)
{
    size_t n = strlen(list);

    snprintf(list + n, CONF_TEXT - n, "%s%s", n > 0 ? "," : "", name);
}

int
conf_reload(const struct conf_table *t, void *settings, void *loaded, int argc,
            char *argv[], char later[CONF_TEXT], struct rad_error *err)
{
    void *fresh = malloc(t->size);
    int rc;

    later[0] = '\0';
    if (!fresh)
        return rad_fail_memory(err);
    rc = conf_load(t, fresh, argc, argv, err);
    for (const struct conf_key *k = t->keys; rc == CONF_RUN && k->name; k++) {
        if (same_field(k, fresh, loaded))
            continue;
        if (k->reload) {
            copy_field(k, settings, fresh);
            copy_field(k, loaded, fresh);
        } else {
            add_name(later, k->name);
        }
    }
    free(fresh);
    return rc < 0 ? rc : 0;
}

static void
put_line(void *arg, const char *text)
{
    (void)arg;
    puts(text);
}

static void
help_line(const char *option, const char *help, const char *def)
{
    char head[80], text[300];
    bool shown = def && def[0];

    snprintf(head, sizeof head, "--%s", option);
    snprintf(text, sizeof text, "%s%s%s%s", help, shown ? " (" : "",
             shown ? def : "", shown ? ")" : "");
    rad_help_row(head, text, put_line, NULL);
}

void
conf_help(const struct conf_table *t)
{
    struct options o;
    char option[64];

    make_options(t, &o);
    printf("usage: %s %s\n", t->program, t->synopsis);
    if (t->about)
        printf("%s\n\n", t->about);
    for (int i = 0; t->keys[i].name; i++) {
        const struct conf_key *k = &t->keys[i];

        if (!k->arg)
            continue;
        snprintf(option, sizeof option, "%s%s%s", o.names[i],
                 k->arg[0] ? "=" : "", k->arg);
        help_line(option, k->help, k->def);
    }
    help_line("config=FILE", "settings, one 'key = value' a line", t->file);
    help_line("help", "this text", NULL);
    help_line("version", "the program's version", NULL);
}

void
conf_version(const struct conf_table *t)
{
    printf("%s (radd) %s\n", t->program, PACKAGE_VERSION);
}
