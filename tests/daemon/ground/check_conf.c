/* check_conf.c - settings from a file and a command line, and addresses */
#include "config.h"

#include "net/address.h"
#include "ground/conf.h"
#include "net/log.h"

#include "tests/unit.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct settings {
    char name[CONF_TEXT];
    int threads;
    bool loud;
    int hidden;
};

static int
check(const void *settings, struct rad_error *err)
{
    const struct settings *s = settings;

    if (strcmp(s->name, "forbidden") == 0)
        return rad_fail(err, RAD_EUSAGE, "forbidden name");
    return 0;
}

#define FIELD(f) offsetof(struct settings, f)
static const struct conf_key keys[] = {
    { "host_name", CONF_TEXT_KEY, FIELD(name), 0, 0, "none", "NAME", "", true },
    { "threads", CONF_INT_KEY, FIELD(threads), 0, 64, "2", "N", "", false },
    { "loud", CONF_BOOL_KEY, FIELD(loud), 0, 0, "no", "", "", true },
    { "hidden", CONF_INT_KEY, FIELD(hidden), 0, 9, "0", NULL, NULL, false },
    { NULL, 0, 0, 0, 0, NULL, NULL, NULL, false },
};

static int
check_text(const char *name, const char *value, struct rad_error *err)
{
    if (strcmp(name, "host_name") == 0 && strcmp(value, "misspelt") == 0)
        return rad_fail(err, RAD_EUSAGE, "no such host");
    return 0;
}

static const struct conf_table table = { .program = "radd",
                                         .synopsis = "",
                                         .keys = keys,
                                         .size = sizeof(struct settings),
                                         .check_text = check_text,
                                         .check = check };

static char path[] = "/tmp/check_conf.XXXXXX";

static void
write_file(const char *text)
{
    FILE *f = fopen(path, "w");

    ck_assert_ptr_nonnull(f);
    ck_assert_int_ge(fputs(text, f), 0);
    ck_assert_int_eq(fclose(f), 0);
}

static int
load(struct settings *s, struct rad_error *err, const char *a, const char *b)
{
    char *argv[] = { (char *)"radd", (char *)a, (char *)b, NULL };
    int argc = 1 + (a != NULL) + (b != NULL);

    memset(err, 0, sizeof *err);
    return conf_load(&table, s, argc, argv, err);
}

TEST(defaults_then_file_then_options)
{
    char config[64];
    struct settings s;
    struct rad_error err;

    snprintf(config, sizeof config, "--config=%s", path);
    ck_assert_int_eq(load(&s, &err, NULL, NULL), CONF_RUN);
    ck_assert_str_eq(s.name, "none");
    ck_assert_int_eq(s.threads, 2);
    ck_assert(!s.loud);

    write_file("# ours\nhost_name = ws3\n[radd]\nthreads=7\nloud = yes\n");
    ck_assert_int_eq(load(&s, &err, config, NULL), CONF_RUN);
    ck_assert_str_eq(s.name, "ws3");
    ck_assert_int_eq(s.threads, 7);
    ck_assert(s.loud);

    ck_assert_int_eq(load(&s, &err, config, "--threads=9"), CONF_RUN);
    ck_assert_int_eq(s.threads, 9);
    ck_assert_str_eq(s.name, "ws3");
}

TEST(reload_changes_what_may_change)
{
    char config[64];
    char *argv[] = { (char *)"radd", config, NULL };
    char later[CONF_TEXT];
    struct settings s, loaded;
    struct rad_error err = { 0 };

    snprintf(config, sizeof config, "--config=%s", path);
    write_file("host_name = a\nthreads = 3\n");
    ck_assert_int_eq(conf_load(&table, &s, 2, argv, &err), CONF_RUN);
    loaded = s;
    s.threads = 5; /* what a daemon makes of it is no change of the file */
    write_file("host_name = b\nthreads = 3\n");
    ck_assert_int_eq(conf_reload(&table, &s, &loaded, 2, argv, later, &err), 0);
    ck_assert_str_eq(s.name, "b");
    ck_assert_str_eq(later, "");
    write_file("host_name = b\nthreads = 4\n");
    for (int twice = 0; twice < 2; twice++) {
        ck_assert_int_eq(
            conf_reload(&table, &s, &loaded, 2, argv, later, &err), 0);
        ck_assert_str_eq(later, "threads");
        ck_assert_int_eq(s.threads, 5);
    }
    write_file("host_name = c\nthreads = many\n");
    ck_assert_int_eq(conf_reload(&table, &s, &loaded, 2, argv, later, &err),
                     RAD_ECONFIG);
    ck_assert_str_eq(s.name, "b");
}

/* The file is to blame where the options alone would do. */
TEST(check_that_fails_names_the_file_or_the_options)
{
    char config[64];
    struct settings s;
    struct rad_error err;

    snprintf(config, sizeof config, "--config=%s", path);
    write_file("host_name = forbidden\n");
    ck_assert_int_eq(load(&s, &err, config, NULL), RAD_ECONFIG);
    ck_assert_str_eq(err.where, path);
    ck_assert_int_eq(err.code, RAD_ECONFIG);
    ck_assert_int_eq(load(&s, &err, config, "--host-name=free"), CONF_RUN);
    ck_assert_int_eq(load(&s, &err, config, "--host-name=forbidden"),
                     RAD_EUSAGE);
    ck_assert_str_eq(err.where, "");
    ck_assert_int_eq(load(&s, &err, "--host-name=misspelt", NULL), RAD_EUSAGE);
    ck_assert_str_eq(err.what, "'host_name': no such host");
}

TEST(int_option_takes_a_whole_word)
{
    static const char *const bad[] = { "--threads=",    "--threads= 3",
                                       "--threads=3 ",  "--threads=0x3",
                                       "--threads=3.0", "--threads=nan",
                                       "--threads=65" };
    struct settings s;
    struct rad_error err;

    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        ck_assert_int_eq(load(&s, &err, bad[i], NULL), RAD_EUSAGE);
    ck_assert_int_eq(load(&s, &err, "--threads=3", NULL), CONF_RUN);
    ck_assert_int_eq(s.threads, 3);
}

TEST(bool_option_takes_a_value_or_none)
{
    struct settings s;
    struct rad_error err;

    ck_assert_int_eq(load(&s, &err, "--loud", NULL), CONF_RUN);
    ck_assert(s.loud);
    ck_assert_int_eq(load(&s, &err, "--loud=yes", NULL), CONF_RUN);
    ck_assert(s.loud);
    ck_assert_int_eq(load(&s, &err, "--loud", "--loud=no"), CONF_RUN);
    ck_assert(!s.loud);
    ck_assert_int_eq(load(&s, &err, "--loud=perhaps", NULL), RAD_EUSAGE);
}

static const struct {
    const char *text, *where, *what;
} bad_files[] = {
    { "host_name = x\n\nthreads = 65\n", ":3", "'threads': 65 is not within" },
    { "threads = 3x\n", ":1", "bad number '3x'" },
    { "loud = perhaps\n", ":1", "expected yes or no" },
    { "threads = 3\n[radd]\nloud = yes\nthreads = 3\n", ":4",
      "'threads' is there twice" },
    { "thread = 3\n", ":1", "unknown key 'thread'" },
    { "hidden = 3\n", ":1", "unknown key 'hidden'" },
    { "threads = 1\nhost_name = misspelt\n", ":2",
      "'host_name': no such host" },
    { "[radcoord]\nthreads = 3\n", ":2", "unknown section 'radcoord'" },
    { "host_name = x\nnonsense\n", ":2", "expected 'key = value'" },
    { "host_name = "
      "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"
      "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"
      "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"
      "\n",
      ":1", "line longer than" },
};

LOOP_TEST(bad_file_is_refused_with_its_line, N_ELEM(bad_files))
{
    struct settings s;
    struct rad_error err = { 0 };

    write_file(bad_files[_i].text);
    conf_defaults(&table, &s);
    ck_assert_int_eq(conf_read(&table, &s, path, &err), RAD_ECONFIG);
    ck_assert_msg(strstr(err.where, bad_files[_i].where) != NULL, "%s",
                  err.where);
    ck_assert_msg(strstr(err.what, bad_files[_i].what) != NULL, "%s", err.what);
}

static const struct {
    const char *word, *what;
} bad_options[] = {
    { "--threads=x", "'threads': bad number 'x'" },
    { "--threads=-1", "'threads': -1 is not within" },
    { "--threads=", "'threads': bad number ''" },
    { "--nothing", "option '--nothing'" },
    { "word", "argument 'word'" },
    { "--host-name", "'--host-name' needs a value" },
    { "--loud=maybe", "got 'maybe'" },
    { "-x", "option '-x'" },
    { "-xyz", "option '-xyz'" },
    { "--threads=99999999999999999999", "'threads'" },
    { "--host-name=forbidden", "forbidden" },
};

LOOP_TEST(bad_option_is_a_usage_error, N_ELEM(bad_options))
{
    struct settings s;
    struct rad_error err;

    ck_assert_int_eq(load(&s, &err, "--loud", bad_options[_i].word),
                     RAD_EUSAGE);
    ck_assert_int_eq(err.code, RAD_EUSAGE);
    ck_assert_msg(strstr(err.what, bad_options[_i].what) != NULL, "%s",
                  err.what);
}

TEST(missing_file_is_named)
{
    struct settings s;
    struct rad_error err;

    ck_assert_int_eq(load(&s, &err, "--config=/nonexistent/x", NULL),
                     RAD_ENOINPUT);
    ck_assert_ptr_nonnull(strstr(err.what, "/nonexistent/x"));
    ck_assert_int_eq(load(&s, &err, "--config=/", NULL), RAD_EIO);
    ck_assert_str_eq(err.what, "cannot read '/': Is a directory");
}

/* A link that leads to itself is denied to root, too. */
TEST(default_file_that_cannot_be_read_is_not_as_if_missing)
{
    struct conf_table of = table;
    char *argv[] = { (char *)"radd", NULL };
    struct settings s;
    struct rad_error err = { 0 };

    of.file = path;
    ck_assert_int_eq(unlink(path), 0);
    ck_assert_int_eq(conf_load(&of, &s, 1, argv, &err), CONF_RUN);
    ck_assert_int_eq(symlink(path, path), 0);
    ck_assert_int_eq(conf_load(&of, &s, 1, argv, &err), RAD_ENOINPUT);
    ck_assert_ptr_nonnull(strstr(err.what, path));
    ck_assert_int_eq(unlink(path), 0);
}

TEST(help_and_version_win)
{
    struct settings s;
    struct rad_error err;

    ck_assert_int_eq(load(&s, &err, "--help", NULL), CONF_HELP);
    ck_assert_int_eq(load(&s, &err, "--version", NULL), CONF_VERSION);
}

static const struct {
    const char *text;
    int code; /* of address_resolve() */
    bool loopback;
    const char *again; /* address_format() */
} addresses[] = {
    { "127.0.0.1:7420", 0, true, "127.0.0.1:7420" },
    { "127.200.3.4:0", 0, true, "127.200.3.4:0" },
    { "[::1]:80", 0, true, "[::1]:80" },
    { "128.0.0.1:80", 0, false, "128.0.0.1:80" },
    { "0.0.0.0:80", 0, false, "0.0.0.0:80" },
    { "[::]:80", 0, false, "[::]:80" },
    { "[fe80::1]:80", 0, false, "[fe80::1]:80" },
    { "/run/x.sock", 0, true, "/run/x.sock" },
    { "./x", 0, true, "./x" },
    { "", RAD_EUSAGE, false, NULL },
    { ":80", RAD_EUSAGE, false, NULL },
    { "127.0.0.1", RAD_EUSAGE, false, NULL },
    { "127.0.0.1:", RAD_EUSAGE, false, NULL },
    { "127.0.0.1:8x", RAD_EUSAGE, false, NULL },
    { "127.0.0.1:123456", RAD_EUSAGE, false, NULL },
    { "127.0.0.1:65535", 0, true, "127.0.0.1:65535" },
    { "127.0.0.1:65536", RAD_EUSAGE, false, NULL }, /* no port 0 */
    { "127.0.0.1:99999", RAD_EUSAGE, false, NULL },
    { "/a/socket/path/that/is/longer/than/the/hundred/and/eight/bytes/that/"
      "the/kernel/has/room/for/xxxxxxxxxxxxxxxxxxxxxxxx",
      RAD_EUSAGE, false, NULL },
};

static const char *const bare[] = {
    "::1",          "::1:7420",          "fe80::1",
    "fe80::1%eth0", "fe80::1%eth0:7420", "::ffff:10.0.0.1"
};

LOOP_TEST(an_address_without_its_brackets_is_told, N_ELEM(bare))
{
    struct rad_error err = { 0 };
    struct address a;

    ck_assert_int_eq(address_resolve(bare[_i], &a, 1, &err), RAD_EUSAGE);
    ck_assert_ptr_nonnull(strstr(err.what, "stands in brackets"));
    memset(&err, 0, sizeof err);
    ck_assert_int_eq(address_resolve_listen(bare[_i], &a, &err), RAD_EUSAGE);
    ck_assert_ptr_nonnull(strstr(err.what, "stands in brackets"));
}

LOOP_TEST(address_is_read_and_judged, N_ELEM(addresses))
{
    struct address a;
    struct rad_error err = { 0 };
    char text[ADDRESS_TEXT];

    ck_assert_int_eq(address_resolve(addresses[_i].text, &a, 1, &err),
                     addresses[_i].code ? addresses[_i].code : 1);
    if (addresses[_i].code)
        return;
    ck_assert_int_eq(address_is_loopback(&a), addresses[_i].loopback);
    ck_assert_int_eq(address_permitted(&a, "x", NULL),
                     addresses[_i].loopback ? 0 : RAD_EPERM);
    address_format(&a, text);
    ck_assert_str_eq(text, addresses[_i].again);
}

static const struct {
    const char *text;
    int code;
    const char *again;
} listens[] = {
    { "*:7420", 0, "[::]:7420" },
    { "*:0", 0, "[::]:0" },
    { "localhost:7420", 0, "127.0.0.1:7420" }, /* and not [::1] */
    { "[::1]:7420", 0, "[::1]:7420" },
    { "0.0.0.0:7420", 0, "0.0.0.0:7420" },
    { "/run/x.sock", 0, "/run/x.sock" },
    { "**:7420", RAD_EUNAVAIL, NULL },
    { "*:", RAD_EUSAGE, NULL },
};

LOOP_TEST(address_to_listen_at, N_ELEM(listens))
{
    struct address a;
    struct rad_error err = { 0 };
    char text[ADDRESS_TEXT];

    ck_assert_int_eq(address_resolve_listen(listens[_i].text, &a, &err),
                     listens[_i].code);
    if (listens[_i].code)
        return;
    address_format(&a, text);
    ck_assert_str_eq(text, listens[_i].again);
    if (listens[_i].text[0] != '*')
        return;
    ck_assert_int_eq(address_resolve(listens[_i].text, &a, 1, &err),
                     RAD_EUSAGE);
    ck_assert_int_eq(address_permitted(&a, "x", NULL), RAD_EPERM);
}

TEST(a_number_or_a_path_is_one_address)
{
    static const char *const one[] = { "127.0.0.1:80", "/run/x.sock" };
    struct address a[2];

    for (size_t i = 0; i < N_ELEM(one); i++)
        ck_assert_int_eq(address_resolve(one[i], a, 2, NULL), 1);
}

TEST(log_limit_lets_a_burst_through_and_counts_the_rest)
{
    struct log_limit l = { 0 };
    unsigned dropped, passed = 0;

    for (uint64_t t = 0; t < 1000; t++)
        passed += log_allowed(&l, t, &dropped);
    ck_assert_uint_eq(passed, LOG_BURST);
    ck_assert(log_allowed(&l, LOG_WINDOW_MS, &dropped));
    ck_assert_uint_eq(dropped, 1000 - LOG_BURST);
    ck_assert_int_eq(log_level_parse("warn"), LOG_LEVEL_WARN);
    ck_assert_int_lt(log_level_parse("loud"), 0);
}
