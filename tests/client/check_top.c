/* check_top.c - what radctl top shows, and what keys do, without a terminal;
 * what radctl says of one job and of the coordinator */
#include "config.h"

#include "ctl/ctl.h"
#include "ctl/top_rows.h"
#include "base/text.h"
#include "tests/unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 60 };

struct picture {
    char line[LINES][600];
    enum top_look look[LINES];
    int columns, lines;
};

static void
put(void *arg, int line, enum top_look look, const char *text)
{
    struct picture *p = arg;

    ck_assert_int_ge(line, 0);
    ck_assert_int_lt(line, p->lines);
    ck_assert_uint_le(rad_text_width(text), (size_t)p->columns);
    snprintf(p->line[line], sizeof p->line[0], "%s", text);
    p->look[line] = look;
}

static struct top t;
static struct picture picture;

static void
set_up(void)
{
    top_init(&t);
}

static void
tear_down(void)
{
    top_release(&t);
}

FIXTURE(set_up, tear_down)

static const struct picture *
draw(int columns, int lines)
{
    memset(&picture, 0, sizeof picture);
    picture.columns = columns;
    picture.lines = lines;
    top_draw(&t, columns, lines, put, &picture);
    return &picture;
}

/* The first line with that text; -1: there is none. */
static int
line_with(const struct picture *p, const char *text)
{
    for (int i = 0; i < p->lines; i++)
        if (strstr(p->line[i], text))
            return i;
    return -1;
}

static json_t *
parse(const char *text)
{
    json_error_t why;
    json_t *root = json_loads(text, 0, &why);

    ck_assert_msg(root != NULL, "%s", why.text);
    return root;
}

static const char status[] =
    "{\"program\":\"radcoord 1\",\"workers\":2,\"threads\":12,\"jobs\":3}";
static const char workers[] =
    "[{\"name\":\"ws1\",\"state\":\"working\",\"threads\":8,\"units\":2,"
    "\"load\":7.25,\"rays\":%d,\"redundant\":12345,\"memory\":10485760,"
    "\"cache\":678,\"since_s\":75,\"address\":\"tcp 10.0.0.1:7421\"},"
    "{\"name\":\"ws2\",\"state\":\"drained\",\"threads\":4,\"units\":0,"
    "\"since_s\":7300,\"address\":\"tcp 10.0.0.2:7421\"}]";
/* newest first, as the coordinator tells them */
static const char jobs[] =
    "[{\"job\":\"cc000000000000000000000000000000\",\"name\":\"stairs\","
    "\"owner\":\"bob\",\"state\":\"paused\",\"priority\":0,\"done\":0.5,"
    "\"rays\":7,\"elapsed_s\":4,\"workers\":0},"
    "{\"job\":\"bb000000000000000000000000000000\",\"name\":\"atrium\","
    "\"owner\":\"ana\",\"state\":\"waiting\",\"priority\":5,\"done\":0,"
    "\"rays\":0,\"elapsed_s\":0,\"workers\":0},"
    "{\"job\":\"aa000000000000000000000000000000\",\"name\":\"room\","
    "\"owner\":\"ana\",\"state\":\"running\",\"priority\":0,\"done\":0.25,"
    "\"rays\":%d,\"elapsed_s\":30,\"left_s\":90,\"workers\":2,\"error\":0.034,"
    "\"pass\":3,\"passes\":7,"
    "\"pass_done\":0.5,\"units_done\":2,\"units_total\":4,\"text\":\"\"}]";
static const char stats[] =
    "{\"job\":\"aa000000000000000000000000000000\","
    "\"time\":{\"wall_s\":40},"
    "\"totals\":{\"ambient_values\":500,\"ambient_redundant\":12},"
    "\"workers\":[{\"name\":\"ws1\",\"rays\":20,\"units\":2,"
    "\"peak_rss_bytes\":10485760},{\"name\":\"ws2\",\"rays\":10,\"units\":1,"
    "\"peak_rss_bytes\":2048}],"
    "\"running\":[{\"worker\":\"ws2\",\"start_s\":20,\"end_s\":40}],"
    "\"units\":[{\"worker\":\"ws1\",\"start_s\":0,\"end_s\":10},"
    "{\"worker\":\"ws1\",\"start_s\":10,\"end_s\":20},"
    "{\"worker\":\"ws2\",\"start_s\":10,\"end_s\":20}]}";

static json_t *
parse_with(const char *fmt, int rays)
{
    char text[3000];

    snprintf(text, sizeof text, fmt, rays);
    return parse(text);
}

static void
take(double s, int rays)
{
    top_take(&t, s, parse(status), parse_with(workers, rays),
             parse_with(jobs, rays), t.job[0] ? parse(stats) : NULL);
}

static void
type(const char *keys)
{
    for (; *keys; keys++)
        ck_assert_int_ne(top_key(&t, *keys), TOP_QUIT);
}

TEST(lists_show_workers_and_jobs)
{
    const struct picture *p;

    take(1, 1000);
    take(3, 2001000);
    p = draw(120, 24);
    ck_assert_str_eq(
        p->line[0], "radcoord 1   2 workers, 12 threads   3 jobs   1 M rays/s");
    ck_assert_int_ge(line_with(p, "WORKER "), 0);
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "ws1")], "10 MiB"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "ws1")], "1:15"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "ws1")],
                                 "  7.2        8      2      1 M     12.3 k  "
                                 "  10 MiB     678      1:15"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "room")], "  2/2  "));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "ws2")], "2 h 01"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "room")], "25 %"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "room")], "1:30"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "room")], "3.4 %"));
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "room")], "3/7"));
    ck_assert_ptr_null(strstr(p->line[line_with(p, "stairs")], "4 s"));
    /* the highest priority first, then the oldest; that one is chosen */
    ck_assert_int_lt(line_with(p, "atrium"), line_with(p, "room"));
    ck_assert_int_lt(line_with(p, "room"), line_with(p, "stairs"));
    ck_assert_int_eq(p->look[line_with(p, "atrium")], TOP_CHOSEN);
}

/* However many newer jobs are over, and whatever the priority of these. */
TEST(jobs_that_are_over_come_last)
{
    static const char more[] =
        "[{\"job\":\"ee\",\"name\":\"newest\",\"state\":\"done\","
        "\"priority\":0},{\"job\":\"dd\",\"name\":\"older\","
        "\"state\":\"failed\",\"priority\":9},{\"job\":\"aa\","
        "\"name\":\"room\",\"state\":\"paused\",\"priority\":0}]";
    const struct picture *p;

    top_take(&t, 1, parse(status), parse_with(workers, 1), parse(more), NULL);
    p = draw(120, 24);
    ck_assert_int_lt(line_with(p, "room"), line_with(p, "newest"));
    ck_assert_int_lt(line_with(p, "newest"), line_with(p, "older"));
}

/* It ended after the open jobs were told, and before the others were. */
TEST(a_job_that_ends_meanwhile_is_listed_once)
{
    static const char twice[] =
        "[{\"job\":\"aa\",\"name\":\"room\",\"state\":\"running\"},"
        "{\"job\":\"bb\",\"name\":\"hall\",\"state\":\"running\"},"
        "{\"job\":\"aa\",\"name\":\"room\",\"state\":\"done\"}]";
    const struct picture *p;
    int at;

    top_take(&t, 1, parse(status), parse_with(workers, 1), parse(twice), NULL);
    p = draw(120, 24);
    at = line_with(p, "room");
    ck_assert_int_gt(at, line_with(p, "hall"));
    ck_assert_ptr_nonnull(strstr(p->line[at], "done"));
    ck_assert_ptr_null(strstr(p->line[line_with(p, "hall") - 1], "room"));
}

TEST(narrow_terminals_leave_out_columns)
{
    const struct picture *p;

    take(1, 1000);
    for (int columns = 1; columns <= 200; columns++)
        for (int lines = 1; lines < 40; lines += 3)
            draw(columns, lines); /* put() checks them */
    p = draw(40, 24);
    ck_assert_int_ge(line_with(p, "STATE"), 0);
    ck_assert_int_ge(line_with(p, "DONE"), 0);
    ck_assert_int_lt(line_with(p, "OWNER"), 0);
    ck_assert_int_lt(line_with(p, "ADDRESS"), 0);
    p = draw(40, 6); /* the list that keys are for, alone */
    ck_assert_int_ge(line_with(p, "JOB"), 0);
    ck_assert_int_lt(line_with(p, "WORKER"), 0);
}

TEST(keys_sort_and_filter)
{
    const struct picture *p;

    take(1, 1000);
    type("ss"); /* by name */
    p = draw(120, 24);
    ck_assert_int_lt(line_with(p, "atrium"), line_with(p, "room"));
    ck_assert_int_ge(line_with(p, "NAMEv"), 0);
    type("r");
    p = draw(120, 24);
    ck_assert_int_gt(line_with(p, "atrium"), line_with(p, "stairs"));
    ck_assert_int_ge(line_with(p, "NAME^"), 0);
    type("/bobq");
    p = draw(120, 24);
    ck_assert_int_ge(line_with(p, "filter: bobq_"), 0);
    ck_assert_int_lt(line_with(p, "stairs"), 0);
    top_key(&t, TOP_KEY_ERASE);
    top_key(&t, TOP_KEY_ENTER);
    p = draw(120, 24);
    ck_assert_int_ge(line_with(p, "stairs"), 0);
    ck_assert_int_lt(line_with(p, "room"), 0);
    ck_assert_str_eq(top_name(TOP_JOBS, top_chosen(&t, TOP_JOBS)),
                     "cc000000000000000000000000000000");
    ck_assert_int_eq(top_key(&t, TOP_KEY_BACK), TOP_NOTHING);
    ck_assert_int_ge(line_with(draw(120, 24), "room"), 0);
    ck_assert_int_eq(top_key(&t, 'q'), TOP_QUIT);
}

TEST(what_changes_something_is_asked_first)
{
    take(1, 1000);
    ck_assert_int_eq(top_key(&t, TOP_KEY_DOWN), TOP_NOTHING);
    ck_assert_int_eq(top_key(&t, 'c'), TOP_NOTHING);
    ck_assert_int_ge(line_with(draw(80, 24), "cancel job aa0000"), 0);
    ck_assert_int_eq(top_key(&t, 'n'), TOP_NOTHING);
    ck_assert_int_eq(top_key(&t, 'y'), TOP_NOTHING); /* nothing is asked now */
    top_key(&t, 'c');
    take(2, 2000); /* the question stays */
    ck_assert_int_eq(top_key(&t, 'y'), TOP_CANCEL);
    ck_assert_str_eq(t.about, "aa000000000000000000000000000000");
    top_key(&t, 'p');
    ck_assert_int_eq(top_key(&t, 'y'), TOP_PAUSE);
    top_key(&t, TOP_KEY_PAGE_DOWN);
    top_key(&t, 'p');
    ck_assert_int_eq(top_key(&t, 'y'), TOP_RESUME);
    ck_assert_str_eq(t.about, "cc000000000000000000000000000000");
    top_key(&t, '\t');
    top_key(&t, 'd');
    ck_assert_int_eq(top_key(&t, 'Y'), TOP_DRAIN);
    ck_assert_str_eq(t.about, "ws1");
    top_key(&t, TOP_KEY_DOWN);
    top_key(&t, 'd');
    ck_assert_int_eq(top_key(&t, 'y'), TOP_UNDRAIN);
    ck_assert_str_eq(t.about, "ws2");
    ck_assert_int_eq(top_key(&t, 'a'), TOP_LOOK);
    ck_assert(t.closed);
}

TEST(a_job_has_its_units_by_worker)
{
    const struct picture *p;
    char bar[41];

    take(1, 1000);
    top_key(&t, TOP_KEY_DOWN);
    ck_assert_int_eq(top_key(&t, TOP_KEY_ENTER), TOP_LOOK);
    take(2, 2000);
    p = draw(46 + 40, 24);
    ck_assert_ptr_nonnull(strstr(p->line[0], "job aa000000  room  of ana"));
    ck_assert_int_ge(line_with(p, "running, 25 % done, left 1:30, pass 3 of 7 "
                                  "to 50 %, error about 3.4 %"),
                     0);
    ck_assert_int_ge(line_with(p, "500 ambient values, 12 redundant"), 0);
    /* 40 columns are 40 s */
    memset(bar, '#', 10);
    memset(bar + 10, '=', 10);
    memset(bar + 20, '.', 20);
    bar[40] = '\0';
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "ws1")], bar));
    memset(bar, '.', 10);
    memset(bar + 10, '#', 10);
    memset(bar + 20, '>', 20); /* that it is at */
    ck_assert_ptr_nonnull(strstr(p->line[line_with(p, "ws2")], bar));
    top_key(&t, 'c');
    ck_assert_int_eq(top_key(&t, 'y'), TOP_CANCEL);
    top_key(&t, TOP_KEY_DOWN);
    p = draw(100, 24);
    ck_assert_int_lt(line_with(p, "ws1"), 0);
    ck_assert_int_ge(line_with(p, "ws2"), 0);
    ck_assert_int_eq(top_key(&t, 'q'), TOP_LOOK); /* back to the lists */
    ck_assert_int_ge(line_with(draw(100, 24), "atrium"), 0);
}

TEST(what_is_strange_is_drawn_all_the_same)
{
    static const char *const rows[] = {
        "[]",
        "[{}]",
        ("[{\"name\":\"\\u001b[31m\\u202eevil\",\"job\":\"\\u009b2J\","
         "\"state\":7,\"done\":1e300,\"rays\":-1e300,\"elapsed_s\":1e300,"
         "\"since_s\":1e300,\"memory\":1e300,\"pass\":1e300,\"workers\":[]}]"),
        ("[{\"job\":\"aa\",\"state\":\"running\",\"done\":0.5,"
         "\"elapsed_s\":1e308,\"rays\":1e308,\"name\":5}]"),
    };
    static const char odd[] =
        "{\"job\":\"aa\",\"time\":{\"wall_s\":1},\"running\":[{},5],"
        "\"workers\":[{\"name\":\"a\"}"
        ","
        "3,{\"rays\":1e300,\"peak_rss_bytes\":1e300}],\"units\":[7,{\"worker\":"
        "\"a\",\"start_s\":1e300,\"end_s\":-1},{\"worker\":\"a\",\"start_s\":0,"
        "\"end_s\":-5},{\"worker\":\"a\",\"start_s\":-4,\"end_s\":1e9}]}";

    draw(80, 24); /* nothing came yet */
    ck_assert_int_eq(top_key(&t, 'c'), TOP_NOTHING);
    ck_assert_int_eq(top_key(&t, 'y'), TOP_NOTHING);
    ck_assert_int_eq(top_key(&t, TOP_KEY_ENTER), TOP_NOTHING);
    for (int i = 0; i < 2 * N_ELEM(rows); i++) {
        const struct picture *p;

        top_take(&t, i + 1, json_object(), parse(rows[i / 2]),
                 parse(rows[i / 2]), parse(odd));
        p = draw(150, 24);
        for (int k = 0; k < p->lines; k++)
            ck_assert(!strchr(p->line[k], '\033') &&
                      !strstr(p->line[k], "\xe2\x80\xae"));
        type("s/");
        top_key(&t, TOP_KEY_BACK);
    }
    top_key(&t, TOP_KEY_ENTER);
    top_take(&t, 99, json_object(), parse(rows[3]), parse(rows[3]), parse(odd));
    draw(150, 24);
    draw(46, 3);
}

TEST(many_rows_scroll_with_the_chosen_one)
{
    json_t *rows = json_array();
    char name[20];

    for (int i = 0; i < 500; i++) {
        snprintf(name, sizeof name, "ws%03d", i);
        json_array_append_new(rows, json_pack("{s:s}", "name", name));
    }
    top_take(&t, 1, parse(status), rows, json_array(), NULL);
    top_key(&t, '\t');
    for (int i = 0; i < 499; i++) {
        const struct picture *p;
        int at;

        snprintf(name, sizeof name, "ws%03d", i);
        p = draw(80, 24);
        at = line_with(p, name);
        ck_assert_int_ge(at, 0);
        ck_assert_int_eq(p->look[at], TOP_CHOSEN);
        top_key(&t, TOP_KEY_DOWN);
    }
    top_key(&t, TOP_KEY_DOWN);
    ck_assert_str_eq(top_name(TOP_WORKERS, top_chosen(&t, TOP_WORKERS)),
                     "ws499");
}

static const struct {
    double s;
    const char *text;
} spans[] = {
    { 0, "0 s" },           { 1.26, "1.3 s" },
    { 59, "59 s" },         { 60, "1 min" },
    { 3599, "59 min" },     { 3600, "1 h 0 min" },
    { 7500, "2 h 5 min" },  { 86399, "23 h 59 min" },
    { 86400, "1 day 0 h" }, { 187200, "2 days 4 h" },
};

LOOP_TEST(a_span_is_told_in_its_two_largest_units, N_ELEM(spans))
{
    char text[CTL_SPAN];

    ck_assert_str_eq(ctl_span(text, spans[_i].s), spans[_i].text);
}

static const struct {
    void (*tell)(FILE *to, const json_t *about);
    const char *about, *name, *value; /* NULL: no such line */
} words[] = {
    { ctl_tell_status, "{}", "since", NULL },
    { ctl_tell_status, "{}", "workers", "none" },
    { ctl_tell_status, "{'workers': 1, 'threads': 1}", "workers",
      "1, with 1 thread" },
    { ctl_tell_status,
      "{'workers': 5, 'threads': 40, 'drained': 2, 'drained_threads': 16}",
      "workers", "3, with 24 threads (2 drained)" },
    { ctl_tell_status, "{'workers': 2, 'threads': 8, 'drained': 2}", "workers",
      "none (2 drained)" },
    { ctl_tell_status, "{'jobs': 2, 'jobs_kept': 5}", "jobs",
      "2 open, 3 over and kept" },
    { ctl_tell_status, "{'disk_full': false}", "disk", NULL },
    { ctl_tell_status, "{'disk_full': true}", "disk",
      "full: jobs are held until there is room" },
    { ctl_tell_status, "{'longest_turn_ms': 5}", "delays", NULL },
    { ctl_tell_status, "{'slow_turns': 1, 'longest_turn_ms': 1234.5}", "delays",
      "everybody had to wait 1 time, for 1200 ms at most" },
    { ctl_tell_job, "{'state': 'waiting', 'text': 'waiting'}", "note", NULL },
    { ctl_tell_job, "{'state': 'failed', 'text': 'no light'}", "note",
      "no light" },
    { ctl_tell_job, "{'status': 0}", "exit status", NULL },
    { ctl_tell_job, "{'status': 65}", "exit status", "65" },
    { ctl_tell_job, "{'done': 0.9999}", "done", "99 %" },
    { ctl_tell_job, "{'done': 1}", "done", "100 %" },
    { ctl_tell_job, "{'pass': 2, 'pass_done': 0.5}", "ambient cache", NULL },
    { ctl_tell_job, "{'passes': 9, 'pass': 2, 'pass_done': 0.555}",
      "ambient cache", "pass 2 of 9, 55 %" },
    { ctl_tell_job, "{'reuse': '0a1b'}", "ambient cache",
      "begins with that of 0a1b" },
    { ctl_tell_job, "{'cache_bytes': 12340000}", "ambient cache",
      "12.3 MB kept for --reuse" },
    { ctl_tell_job, "{'stage': 1, 'stages': 3}", "stage", NULL },
    { ctl_tell_job, "{'goal_error': 0.025}", "asked for", "error of 2.5 %" },
    { ctl_tell_job, "{'goal_time_s': 90}", "asked for", "90 s" },
    { ctl_tell_job, "{'goal_error': 0.05, 'goal_time_s': 90}", "asked for",
      "error of 5 %, within 90 s" },
    { ctl_tell_job, "{'goal_error': 0.05, 'stage': 1, 'stages': 6}", "stage",
      "1 of at most 6" },
    { ctl_tell_job,
      "{'goal_time_s': 9, 'stage': 2, 'stages': 6, 'estimated_error': 0.0312}",
      "stage", "2 of at most 6, estimated error 3.1 %" },
    { ctl_tell_job, "{'width': 40, 'height': 30, 'frames': 1}", "picture",
      "40 x 30" },
    { ctl_tell_job,
      "{'width': 40, 'height': 30, 'frames': 8, 'frames_ready': 3, "
      "'oversample': 2}",
      "picture", "8 frames (3 ready) of 40 x 30 of 2 x 2 samples a pixel" },
    { ctl_tell_job, "{'elapsed_s': 61}", "time",
      "1 min since it was submitted" },
    { ctl_tell_job, "{'rays': 0}", "rays", NULL },
    { ctl_tell_job, "{'rays': 12345678}", "rays", "12.3 million" },
    { ctl_tell_job, "{'units_redone': 0}", "made again", NULL },
    { ctl_tell_job, "{'units_redone': 1}", "made again",
      "1 part of the picture, after a loss" },
};

LOOP_TEST(a_member_becomes_a_line_with_its_unit, N_ELEM(words))
{
    char json[300], *said, *line, *next;
    const char *found = NULL;
    size_t len;
    FILE *to = open_memstream(&said, &len);
    json_t *root;

    snprintf(json, sizeof json, "%s", words[_i].about);
    for (char *c = json; *c; c++)
        *c = *c == '\'' ? '"' : *c;
    root = parse(json);
    words[_i].tell(to, root);
    fclose(to);
    for (line = strtok_r(said, "\n", &next); line;
         line = strtok_r(NULL, "\n", &next)) {
        size_t n = strlen(words[_i].name);

        if (strncmp(line, words[_i].name, n) == 0 && line[n] == ' ')
            found = line + n + strspn(line + n, " ");
    }
    ck_assert_pstr_eq(found, words[_i].value);
    free(said);
    json_decref(root);
}
