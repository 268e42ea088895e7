/* check_client.c - what the clients are made of: addresses, files, progress,
 * tables */
#include "config.h"

#include "common/figure.h"
#include "common/outname.h"
#include "base/files.h"
#include "base/output.h"
#include "trial/progress.h"
#include "common/table.h"
#include "link/launch.h"
#include "link/rescue.h"
#include "link/target.h"
#include "tests/scratch.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

FIXTURE(scratch_make, scratch_remove)

static const struct {
    double x;
    int digits;
    const char *text;
} figures[] = {
    { 0, 2, "0" },         { 1.84, 2, "1.8" },  { 0.6789, 2, "0.68" },
    { 184, 2, "180" },     { 99.6, 2, "100" },  { 2, 3, "2" },
    { 12345, 3, "12300" }, { 0.05, 3, "0.05" }, { 1234567, 3, "1230000" },
    { 9.996, 3, "10" },    { 1e-9, 2, "0" },
};

LOOP_TEST(a_figure_has_no_exponent, N_ELEM(figures))
{
    char text[FIGURE_TEXT];

    ck_assert_str_eq(figure(text, figures[_i].x, figures[_i].digits),
                     figures[_i].text);
}

static const struct {
    const char *text;
    int rc;
    bool local;
    const char *host, *port; /* or host: the path */
} addresses[] = {
    { "/run/radd/coord.sock", 0, true, "/run/radd/coord.sock", "" },
    { "./s", 0, true, "./s", "" },
    { "ws1:1234", 0, false, "ws1", "1234" },
    { "ws1", 0, false, "ws1", "7420" },
    { "[::1]:99", 0, false, "::1", "99" },
    { "[::1]", 0, false, "::1", "7420" },
    { "ws1:", RAD_EUSAGE, false, "", "" },
    { ":7420", RAD_EUSAGE, false, "", "" },
    { "ws1:0", RAD_EUSAGE, false, "", "" },
    { "ws1:65536", RAD_EUSAGE, false, "", "" },
    { "ws1:12x", RAD_EUSAGE, false, "", "" },
    { "::1", RAD_EUSAGE, false, "", "" },
    { "fe80::1%eth0", RAD_EUSAGE, false, "", "" },
    { "[fe80::1%eth0]:99", 0, false, "fe80::1%eth0", "99" },
    { "[::1", RAD_EUSAGE, false, "", "" },
    { "[::1]7:99", RAD_EUSAGE, false, "", "" },
    { "ws1:9:9", RAD_EUSAGE, false, "", "" },
    { "", RAD_EUSAGE, false, "", "" },
};

LOOP_TEST(addresses_are_taken_apart, N_ELEM(addresses))
{
    struct target t;

    ck_assert_int_eq(target_parse(&t, addresses[_i].text, NULL),
                     addresses[_i].rc);
    if (addresses[_i].rc < 0)
        return;
    ck_assert_int_eq(t.local, addresses[_i].local);
    ck_assert_str_eq(t.local ? t.path : t.host, addresses[_i].host);
    ck_assert_str_eq(t.port, addresses[_i].port);
}

static const struct {
    const char *command;
    bool each;
    const char *third; /* of the third worker */
} launches[] = {
    { "srun", false, "srun" },
    { "ssh ws%d", true, "ssh ws3" },
    { "ssh -p 2%d ws%d", true, "ssh -p 23 ws3" },
    { "date +%%d", false, "date +%d" },
    { "echo 100% %d", true, "echo 100% 3" },
    { "echo %%%d%%", true, "echo %3%" },
    { "echo %", false, "echo %" },
    { "", false, "" },
};

LOOP_TEST(launchers_are_numbered, N_ELEM(launches))
{
    char *text = launch_command(launches[_i].command, 3);

    ck_assert_str_eq(text, launches[_i].third);
    ck_assert_int_eq(launch_each(launches[_i].command), launches[_i].each);
    free(text);
}

static const struct {
    const char *given, *dial, *listen; /* dial NULL: refused */
} launch_addresses[] = {
    { "head", "head:0", "*:0" },
    { "head:7000", "head:7000", "*:7000" },
    { "10.0.0.1", "10.0.0.1:0", "*:0" },
    { "[fd00::1]", "[fd00::1]:0", "*:0" },
    { "[fd00::1]:5", "[fd00::1]:5", "*:5" },
    { "", NULL, NULL },
    { "/socket", NULL, NULL },
    { "head:x", NULL, NULL },
    { "fd00::1", NULL, NULL }, /* is this host fd00:: or fd00::1? */
    { ":7000", NULL, NULL },
};

LOOP_TEST(workers_are_told_where_to_dial, N_ELEM(launch_addresses))
{
    char dial[LAUNCH_ADDRESS], listen[LAUNCH_ADDRESS];
    struct rad_error err = { 0 };
    int rc = launch_address(launch_addresses[_i].given, dial, listen, &err);

    if (!launch_addresses[_i].dial) {
        ck_assert_int_eq(rc, RAD_EUSAGE);
        return;
    }
    ck_assert_int_eq(rc, 0);
    ck_assert_str_eq(dial, launch_addresses[_i].dial);
    ck_assert_str_eq(listen, launch_addresses[_i].listen);
}

TEST(an_address_is_chosen_for_workers)
{
    char dial[LAUNCH_ADDRESS], listen[LAUNCH_ADDRESS];
    struct rad_error err = { 0 };

    ck_assert_int_eq(launch_address(NULL, dial, listen, &err), 0);
    ck_assert_str_eq(dial, listen);
    ck_assert_str_eq(strrchr(dial, ':'), ":0");
    ck_assert_str_ne(dial, "0.0.0.0:0");
}

TEST(coordinator_comes_from_the_first_place_that_names_one)
{
    struct target t;
    struct rad_error err = { 0 };
    char path[200];

    unsetenv("RADD_COORDINATOR");
    setenv("XDG_CONFIG_HOME", dir, 1);
    snprintf(path, sizeof path, "%s/radd", dir);
    mkdir(path, 0700);
    scratch_file("radd/radsubmit.conf", "# mine\ncoordinator = ws3:5\n");
    ck_assert_int_eq(target_find(&t, NULL, NULL, &err), 1);
    ck_assert_str_eq(t.host, "ws3");
    setenv("RADD_COORDINATOR", "ws2:5", 1);
    ck_assert_int_eq(target_find(&t, NULL, NULL, &err), 1);
    ck_assert_str_eq(t.host, "ws2");
    ck_assert_int_eq(target_find(&t, "ws1:5", "mine", &err), 1);
    ck_assert_str_eq(t.host, "ws1");
    ck_assert_str_eq(t.key, "mine");
    unsetenv("RADD_COORDINATOR");
    scratch_file("radd/radsubmit.conf", "coordinator = ws3:5\nkey = /my/key\n");
    ck_assert_int_eq(target_find(&t, NULL, NULL, &err), 1);
    ck_assert_str_eq(t.host, "ws3");
    ck_assert_str_eq(t.key, "/my/key");
    setenv("RADD_KEY", "/another/key", 1);
    ck_assert_int_eq(target_find(&t, "ws4:5", NULL, &err), 1);
    ck_assert_str_eq(t.host, "ws4");
    ck_assert_str_eq(t.key, "/another/key");
    unsetenv("RADD_KEY");
    scratch_file("radd/radsubmit.conf", "\ncordinator = ws3:5\n");
    ck_assert_int_eq(target_find(&t, NULL, NULL, &err), RAD_ECONFIG);
    ck_assert_ptr_nonnull(strstr(err.what, "cordinator"));
    ck_assert_ptr_nonnull(strstr(err.where, "radsubmit.conf:2"));
    err = (struct rad_error){ 0 };
    scratch_file("radd/radsubmit.conf", "key = /a\nkey = /b\n");
    ck_assert_int_eq(target_find(&t, NULL, NULL, &err), RAD_ECONFIG);
    ck_assert_ptr_nonnull(strstr(err.where, "radsubmit.conf:2"));
    ck_assert_str_eq(err.what, "'key' is there twice");
}

/* Whoever names them: one that is cut off would be another file's. */
TEST(no_name_of_a_coordinator_or_key_is_cut_off)
{
    struct target t;
    char name[1100];

    memset(name, 'k', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    ck_assert_int_eq(target_find(&t, name, NULL, NULL), RAD_EUSAGE);
    ck_assert_int_eq(target_find(&t, "ws1:5", name, NULL), RAD_EUSAGE);
    setenv("RADD_KEY", name, 1);
    ck_assert_int_eq(target_find(&t, "ws1:5", NULL, NULL), RAD_EUSAGE);
    unsetenv("RADD_KEY");
    setenv("RADD_COORDINATOR", name, 1);
    ck_assert_int_eq(target_find(&t, NULL, NULL, NULL), RAD_EUSAGE);
    unsetenv("RADD_COORDINATOR");
}

TEST(coordinator_of_this_machine_is_at_its_socket)
{
    struct target t;

    unsetenv("RADD_COORDINATOR");
    setenv("XDG_CONFIG_HOME", "/nowhere", 1);
    ck_assert_int_eq(target_find(&t, NULL, NULL, NULL), 0);
    target_default(&t);
    ck_assert(t.local);
    ck_assert_str_eq(t.path, "/run/radd/radcoord.sock");
}

static const struct {
    const char *pattern;
    int frame;
    const char *name; /* NULL: refused */
} frames[] = {
    { "f%d.hdr", 7, "f7.hdr" },
    { "f%03d.hdr", 7, "f007.hdr" },
    { "f%3d.hdr", 7, "f  7.hdr" },
    { "100%%_%d", 12, "100%_12" },
    { "f.hdr", 1, NULL },
    { "f%d%d.hdr", 1, NULL },
    { "f%s.hdr", 1, NULL },
    { "f%-3d.hdr", 1, NULL },
    { "f%*d.hdr", 1, NULL },
    { "f%99999999999d.hdr", 1, NULL },
    { "f%n", 1, NULL },
    { "f%", 1, NULL },
};

LOOP_TEST(frame_numbers_go_into_names, N_ELEM(frames))
{
    char *name = NULL;
    int rc =
        outname_frame(&name, frames[_i].pattern, frames[_i].frame, true, NULL);

    if (frames[_i].name) {
        ck_assert_int_eq(rc, 0);
        ck_assert_str_eq(name, frames[_i].name);
    } else {
        ck_assert_int_eq(rc, RAD_EUSAGE);
    }
    free(name);
}

TEST(outputs_are_whole_or_not_there)
{
    struct rad_output out;
    struct rad_error err = { 0 };
    struct stat st;
    char path[200], link[200], buf[8] = "";
    FILE *f;

    snprintf(path, sizeof path, "%s", scratch_file("pic", "old"));
    snprintf(link, sizeof link, "%s/link", dir);
    ck_assert_int_eq(symlink(path, link), 0);
    ck_assert_int_eq(rad_output_open(&out, link, true, &err), 0);
    fputs("new", out.file);
    fflush(out.file);
    f = fopen(path, "r");
    ck_assert_str_eq(fgets(buf, sizeof buf, f), "old");
    fclose(f);
    ck_assert_int_eq(rad_output_commit(&out, &err), 0);
    rad_output_abort(&out);
    f = fopen(path, "r");
    ck_assert_str_eq(fgets(buf, sizeof buf, f), "new");
    fclose(f);
    ck_assert_int_eq(lstat(link, &st), 0);
    ck_assert(S_ISLNK(st.st_mode));
    ck_assert_int_eq(rad_output_open(&out, path, false, &err), 0);
    ck_assert_int_eq(access(out.temp, F_OK), 0);
    snprintf(link, sizeof link, "%s", out.temp);
    rad_output_abort(&out);
    ck_assert_int_ne(access(link, F_OK), 0);
    ck_assert_int_eq(rad_output_write("/dev/null", "x", 1, true, &err), 0);
    ck_assert_int_eq(stat("/dev/null", &st), 0);
    ck_assert(S_ISCHR(st.st_mode));
}

/* The temporary name is no longer than what a folder takes. */
TEST(outputs_may_have_the_longest_name)
{
    char name[NAME_MAX + 2], path[PATH_MAX];
    struct rad_error err = { 0 };

    memset(name, 'a', sizeof name);
    name[NAME_MAX] = '\0';
    snprintf(path, sizeof path, "%s/%s", dir, name);
    ck_assert_int_eq(rad_output_check(path, &err), 0);
    ck_assert_int_eq(rad_output_write(path, "x", 1, false, &err), 0);
    ck_assert_int_eq(unlink(path), 0);
    strcat(path, "a");
    ck_assert_int_eq(rad_output_check(path, NULL), RAD_ECANTCREAT);
}

TEST(outputs_that_cannot_be_are_known_before)
{
    char path[240];

    snprintf(path, sizeof path, "%s/no/pic.hdr", dir);
    ck_assert_int_eq(rad_output_check(path, NULL), RAD_ECANTCREAT);
    ck_assert_int_eq(rad_output_check(dir, NULL), RAD_ECANTCREAT);
    snprintf(path, sizeof path, "%s/pic.hdr", scratch_file("plain", ""));
    ck_assert_int_eq(rad_output_check(path, NULL), RAD_ECANTCREAT);
    snprintf(path, sizeof path, "%s/pic.hdr", dir);
    ck_assert_int_eq(rad_output_check(path, NULL), 0);
    ck_assert_int_eq(rad_output_check("/dev/null", NULL), 0);
}

static const struct {
    struct progress_report r;
    double rate;
    const char *line;
} lines[] = {
    { { 9, .425, 5, 3, 65 },
      1.254e6,
      " 42 %  1.25 M rays/s  1:05 left  3 workers" },
    { { 9, 0, 0, 1, 0 }, 0, "  0 %  1 worker" },
    { { 9, .1, 5, 1, 0 }, 250, " 10 %  250 rays/s  1 worker" },
    { { 9, .1, 5, 0, 70 }, 250, " 10 %  no worker" },
    { { 9, .9999, 5, 2, 3725 },
      999.6,
      " 99 %  1.00 k rays/s  1:02:05 left  2 workers" },
    { { 9, 1, 5, 2, 0 }, 99960, "100 %  100 k rays/s" },
    { { 9, 1, 5, 0, 0 }, 99960, "100 %  100 k rays/s" },
};

LOOP_TEST(progress_says_what_is_left, N_ELEM(lines))
{
    char buf[200];

    progress_format(buf, sizeof buf, &lines[_i].r, lines[_i].rate);
    ck_assert_str_eq(buf, lines[_i].line);
}

TEST(progress_comes_as_often_as_asked)
{
    struct progress_report r = { .rays = 100, .workers = 1 };
    struct progress p;
    char *text = NULL;
    size_t len = 0;
    FILE *f = open_memstream(&text, &len);
    int shown = 0;

    progress_init(&p, stderr, PROGRESS_NEVER);
    progress_every(&p, f, 10);
    for (int s = 1; s <= 35; s++) {
        r.elapsed_s = s + .1 * (s % 3 - 1);
        r.done = s / 40.;
        progress_update(&p, &r);
    }
    progress_every(&p, f, 1);
    for (int s = 1; s <= 20; s++) { /* twice a second, as they come */
        r.elapsed_s = 40 + .5 * s + .1 * (s % 3 - 1);
        progress_update(&p, &r);
    }
    fclose(f);
    for (size_t i = 0; i < len; i++)
        shown += text[i] == '\n';
    ck_assert_int_eq(shown, 3 + 10);
    ck_assert_ptr_null(strchr(text, '\r'));
    free(text);
}

TEST(time_without_reports_is_not_time_alone)
{
    struct progress_alone a = { 0, 0 };
    struct progress_report r = { .elapsed_s = .5, .workers = 1 };

    ck_assert_double_eq(progress_alone(&a, &r, true), 0);
    r.elapsed_s = 60; /* of a coordinator that has been away */
    r.workers = 0;
    ck_assert_double_eq(progress_alone(&a, &r, true), 1);
    for (int i = 1; i <= 8; i++) {
        r.elapsed_s = 60 + .5 * i;
        ck_assert_double_eq(progress_alone(&a, &r, true), 1 + .5 * i);
    }
    r.elapsed_s = 10; /* a job may begin again */
    ck_assert_double_eq(progress_alone(&a, &r, true), 5);
    r.elapsed_s = 10.5;
    ck_assert_double_eq(progress_alone(&a, &r, false), 0);
    ck_assert_double_eq(progress_alone(&a, &r, true), 0);
    r.elapsed_s = 11;
    ck_assert_double_eq(progress_alone(&a, &r, true), .5);
    r.workers = 1;
    ck_assert_double_eq(progress_alone(&a, &r, true), 0);
}

TEST(progress_ends_with_the_mean_rate)
{
    struct progress p;
    struct progress_report half = { .elapsed_s = 1, .done = .5, .rays = 900 };
    struct progress_report done = { .elapsed_s = 10, .done = 1, .rays = 1000 };
    FILE *f = tmpfile();
    char buf[200];

    progress_init(&p, f, PROGRESS_ALWAYS);
    progress_update(&p, &half);
    progress_update(&p, &done);
    rewind(f);
    ck_assert_ptr_nonnull(fgets(buf, sizeof buf, f));
    ck_assert_ptr_nonnull(fgets(buf, sizeof buf, f));
    ck_assert_str_eq(buf, "100 %  100 rays/s\n");
    fclose(f);
}

/* What a terminal of so many columns shows of a report, then of a shorter one,
 * and when the line is removed. */
static const struct {
    unsigned short columns; /* 0: it does not know */
    const char *shown;
} terminals[] = {
    { 80, "\r 50 %  100 rays/s  0:10 left  1 worker"
          "\r100 %  100 rays/s                     \r100 %  100 rays/s"
          "\r                 \r" },
    { 0, "\r 50 %  100 rays/s  0:10 left  1 worker"
         "\r100 %  100 rays/s                     \r100 %  100 rays/s"
         "\r                 \r" },
    { 12, "\r 50 %  100 \r100 %  100 \r           \r" },
};

LOOP_TEST(progress_keeps_to_its_line_of_a_terminal, N_ELEM(terminals))
{
    struct winsize size = { .ws_col = terminals[_i].columns };
    struct progress_report half = { 10, .5, 1000, 1, 10 };
    struct progress_report done = { 10, 1, 1000, 1, 0 };
    struct progress p;
    char buf[400];
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    size_t got = 0;
    ssize_t n;
    FILE *f;

    ck_assert(grantpt(master) == 0 && unlockpt(master) == 0);
    f = fopen(ptsname(master), "w");
    ck_assert_ptr_nonnull(f);
    ck_assert_int_eq(ioctl(master, TIOCSWINSZ, &size), 0);
    progress_init(&p, f, PROGRESS_AUTO);
    progress_update(&p, &half);
    progress_update(&p, &done);
    progress_clear(&p);
    progress_clear(&p);
    fclose(f);
    while (got < sizeof buf - 1 &&
           (n = read(master, buf + got, sizeof buf - 1 - got)) > 0)
        got += (size_t)n;
    buf[got] = '\0';
    ck_assert_str_eq(buf, terminals[_i].shown);
    close(master);
}

TEST(progress_is_silent_where_nobody_looks)
{
    struct progress p;
    struct progress_report r = { 10, .5, 1000, 1, 10 };
    FILE *f = tmpfile();
    char buf[200];

    progress_init(&p, f, PROGRESS_AUTO);
    progress_update(&p, &r);
    ck_assert_int_eq(ftell(f), 0);
    progress_init(&p, f, PROGRESS_ALWAYS);
    progress_update(&p, &r);
    progress_clear(&p);
    rewind(f);
    ck_assert_ptr_nonnull(fgets(buf, sizeof buf, f));
    ck_assert_str_eq(buf, " 50 %  100 rays/s  0:10 left  1 worker\n");
    fclose(f);
}

static const struct {
    const char *json, *text;
} tables[] = {
    { "[ ]", "no entries\n" },
    { "[{\"name\": \"ws1\", \"units\": 12}, {\"name\": \"w\\u00e4\", "
      "\"units\": 3}]",
      "name  units\nws1      12\nw\xc3\xa4        3\n" },
    { "[{\"a\": 1, \"b\": 2}, {\"b\": 4.5}]",
      "a      b\n1      2\n-  4.500\n" },
    { "{\"job\": \"1f\", \"ok\": true, \"time\": {\"wall_s\": 2.5}}",
      "job  1f\nok   yes\n\ntime\nwall_s  2.500\n" },
    { "{\"units\": [1, 2, 3]}", "units: 3\n" },
    /* what others named cannot steer the terminal */
    { "{\"name\": \"\\u001b[31mred\"}", "name  ?[31mred\n" },
    { "[{\"name\": \"a\\nb\"}]", "name\na?b\n" },
    { "[{\"name\": \"a\\u009b2J\\u202eb\"}]", "name\na?2J?b\n" },
    { "{\"a\\u202eb\": \"\\u2066\\u200b\"}", "a?b  ??\n" },
    /* columns, not characters and not bytes */
    { "[{\"name\": \"事務\", \"n\": 1}, {\"name\": \"abcd\", \"n\": 2}]",
      "name  n\n事務  1\nabcd  2\n" },
    { "[{\"name\": \"事事事事事事事事事事"
      "事事事事事事事事事事"
      "事事事事事事事事事事事\"}]",
      "name\n事事事事事事事事事事事事事事事"
      "事事事事事事事事事事事事事...\n" },
};

LOOP_TEST(json_is_a_table_for_people, N_ELEM(tables))
{
    json_t *root = json_loads(tables[_i].json, 0, NULL);
    FILE *f = tmpfile();
    char buf[300];
    size_t n;

    ck_assert_ptr_nonnull(root);
    table_print(f, root);
    rewind(f);
    n = fread(buf, 1, sizeof buf - 1, f);
    buf[n] = '\0';
    ck_assert_str_eq(buf, tables[_i].text);
    fclose(f);
    json_decref(root);
}

/* Thousands of rows, each once. */
TEST(tables_have_any_length)
{
    json_t *root = json_array();
    FILE *f = tmpfile();
    char buf[80], want[80];

    for (int i = 0; i < 20000; i++)
        json_array_append_new(root, json_pack("{s:i,s:s}", "n", i, "x", "y"));
    table_print(f, root);
    rewind(f);
    ck_assert_ptr_nonnull(fgets(buf, sizeof buf, f));
    for (int i = 0; i < 20000; i++) {
        snprintf(want, sizeof want, "%5d  y\n", i);
        ck_assert_ptr_nonnull(fgets(buf, sizeof buf, f));
        ck_assert_str_eq(buf, want);
    }
    ck_assert_ptr_null(fgets(buf, sizeof buf, f));
    fclose(f);
    json_decref(root);
}

/* The folder of TMPDIR, or one that is always there. */
TEST(results_are_saved_where_there_is_a_place)
{
    static const uint8_t job[MSG_JOB] = { 0x0a, 0x1b };
    const char *const tmpdir[] = { dir, "/nonexistent", "relative" };

    for (int i = 0; i < N_ELEM(tmpdir); i++) {
        unsigned char *bytes;
        char *path;
        size_t n;

        setenv("TMPDIR", tmpdir[i], 1);
        path = rescue_write(job, 3, ".hdr", (const uint8_t *)"light", 5);
        ck_assert_ptr_nonnull(path);
        ck_assert(strncmp(path, dir, strlen(dir)) == 0 ? i == 0 : i > 0);
        ck_assert_ptr_nonnull(strstr(path, "/radsubmit-0a1b0000"));
        ck_assert_str_eq(path + strlen(path) - 6, "-3.hdr");
        bytes = rad_file_read(path, 100, &n, NULL);
        ck_assert_mem_eq(bytes, "light", n);
        ck_assert_uint_eq(n, 5);
        free(bytes);
        unlink(path);
        free(path);
    }
}
