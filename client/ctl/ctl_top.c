/* ctl_top.c - radctl top: the terminal and the coordinator around top.h
 *
 * One loop: ask the coordinator, draw, wait for keys until it is time to ask
 * again.  The coordinator is asked once a second, or less often if its answers
 * take long.  ncurses sends the terminal only what has changed. */
#include "config.h"

#include "ctl/ctl.h"
#include "ctl/top.h"
#include "common/table.h"
#include "machine/lists.h"

#include <curses.h>
#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <term.h>
#include <unistd.h>

enum {
    PERIOD_MS = 1000,
    SLOWER = 5, /* time to the next request, in times of an answer */
    MOST_JOBS = 200,
    ESCAPE_MS = 50, /* to wait for the rest of a key's escape sequence */
    ANSWER_MS = 4500
};

struct screen {
    struct ctl *c;
    struct top top;
    SCREEN *curses;
    uint64_t due_ms; /* of the next request */
};

static volatile sig_atomic_t stopped;

static void
on_stop(int signum)
{
    (void)signum;
    stopped = 1;
}

static uint64_t
now_ms(struct ctl *c)
{
    uv_update_time(&c->loop);
    return uv_now(&c->loop);
}

/* --- the coordinator --- */

/* Get the statistics of the job that is shown.  None come if the job has gone,
 * or the user may not see it. */
static int
ask_job(struct screen *s, json_t **stats)
{
    struct rad_memory_out f = { 0 };
    uint8_t job[MSG_JOB];
    int rc;

    if (!s->top.job[0] || !msg_job_parse(s->top.job, job))
        return 0;
    rc = ctl_fetch_file(s->c, job, 0, MSG_WHAT_STATS, ANSWER_MS, &f);
    if (rc == 0)
        *stats = json_loadb((const char *)f.bytes, f.len, 0, NULL);
    free(f.bytes);
    return rc == RAD_EUNAVAIL || rc == RAD_EPROTO ? rc : 0;
}

/* Get all workers and at most `most` jobs that are not over (0: any number),
 * and behind them, if `closed`, as many that are. */
static int
ask_rows(struct ctl *c, int most, bool closed, json_t **workers, json_t **jobs)
{
    struct msg_page page = { .what = MSG_ROWS_WORKERS, .state = "" };
    json_t *over = NULL;
    int rc;

    c->limit = 0;
    if ((rc = ctl_rows(c, &page, workers)) < 0)
        return rc;
    page = (struct msg_page){ .what = MSG_ROWS_JOBS, .state = "open" };
    c->limit = most;
    if ((rc = ctl_rows(c, &page, jobs)) < 0 || !closed)
        return rc;
    page.state = "over";
    rc = ctl_rows(c, &page, &over);
    json_array_extend(*jobs, over);
    json_decref(over);
    return rc;
}

static int
ask_all(struct screen *s)
{
    struct ctl *c = s->c;
    json_t *status, *workers = NULL, *jobs = NULL, *stats = NULL;
    const struct msg *answer;
    int rc;

    c->start_ms = now_ms(c);
    rc = ctl_query(c, MSG_QUERY_STATUS, NULL, &answer);
    status = rc == 0 ? ctl_parse(c, answer) : NULL;
    if (rc == 0 && !status)
        rc = c->err->code;
    if (rc == 0)
        rc = ask_rows(c, MOST_JOBS, s->top.closed || s->top.job[0], &workers,
                      &jobs); /* the job that is shown may be over */
    if (rc == 0)
        rc = ask_job(s, &stats);
    if (rc == 0) {
        top_take(&s->top, (double)now_ms(c) / 1000 + 1, status, workers, jobs,
                 stats);
        return 0;
    }
    json_decref(status);
    json_decref(workers);
    json_decref(jobs);
    json_decref(stats);
    return rc;
}

static void
note(struct screen *s, const struct rad_error *err)
{
    rad_error_format(err, s->top.note, sizeof s->top.note);
}

/* Ask for all data; dial again first if the coordinator was lost. */
static void
refresh_data(struct screen *s)
{
    struct rad_error *outer = s->c->err, err = { 0 };
    uint64_t begin_ms = now_ms(s->c), took_ms;
    bool lost = s->top.lost;
    int rc = 0;

    s->c->err = &err;
    if (!s->c->link)
        rc = ctl_connect(s->c);
    if (rc == 0)
        rc = ask_all(s);
    if (rc < 0) {
        link_close(s->c->link);
        s->c->link = NULL;
        s->top.lost = true;
        note(s, &err);
    } else if (lost) {
        snprintf(s->top.note, sizeof s->top.note,
                 "the coordinator is there again");
    }
    s->c->err = outer;
    took_ms = now_ms(s->c) - begin_ms;
    s->due_ms = now_ms(s->c) +
                (took_ms * SLOWER > PERIOD_MS ? took_ms * SLOWER : PERIOD_MS);
}

/* Carry out a wish that the user has confirmed. */
static void
carry_out(struct screen *s, enum top_wish wish)
{
    static const uint16_t type[] = { [TOP_CANCEL] = MSG_CANCEL,
                                     [TOP_PAUSE] = MSG_PAUSE,
                                     [TOP_RESUME] = MSG_RESUME,
                                     [TOP_DRAIN] = MSG_DRAIN,
                                     [TOP_UNDRAIN] = MSG_UNDRAIN };
    bool worker = wish == TOP_DRAIN || wish == TOP_UNDRAIN;
    struct rad_error *outer = s->c->err, err = { 0 };
    struct msg m = { .type = type[wish] };
    const struct msg *answer;
    uint8_t job[MSG_JOB];
    int rc;

    s->c->err = &err;
    s->c->start_ms = now_ms(s->c);
    if (!s->c->link)
        rc = rad_fail(&err, RAD_EUNAVAIL, "the coordinator is not there");
    else if (worker && s->c->role != MSG_ROLE_ADMIN)
        rc = rad_fail(&err, RAD_EPERM, "this is for administrators");
    else if (s->c->role == MSG_ROLE_OBSERVER)
        rc = rad_fail(&err, RAD_EPERM, "this is not for observers");
    else if (!worker && !msg_job_parse(s->top.about, job))
        rc = rad_fail(&err, RAD_EPROTO, "'%.40s' is no job", s->top.about);
    else {
        if (worker)
            m.drain.name = s->top.about;
        else
            m.cancel.job = job; /* all these messages have the same struct */
        rc = ctl_ask(s->c, &m, &answer);
    }
    s->c->err = outer;
    s->due_ms = 0;
    if (rc < 0)
        note(s, &err);
}

/* --- the terminal --- */

enum { PAIR_TITLE = 1, PAIR_WARNING };

static bool
colours_wanted(void)
{
    const char *no = getenv("NO_COLOR");

    return has_colors() && !(no && no[0]);
}

/* Is the terminal's type one that can put text anywhere on its screen? */
static bool
has_screen(void)
{
    const char *move;
    int status;

    if (setupterm(NULL, STDOUT_FILENO, &status) != OK)
        return false;
    move = tigetstr("cup");
    del_curterm(cur_term);
    return move != NULL && move != (const char *)-1;
}

static int
open_terminal(struct screen *s)
{
    struct sigaction stop = { .sa_handler = on_stop };

    setlocale(LC_CTYPE, "");
    if (MB_CUR_MAX == 1) /* names are UTF-8, as in radctl's other output */
        setlocale(LC_CTYPE, "C.UTF-8");
    s->curses = has_screen() ? newterm(NULL, stdout, stdin) : NULL;
    if (!s->curses)
        return rad_fail(
            s->c->err, RAD_EUSAGE,
            "the terminal's type, TERM=%.40s, is not known or has no "
            "screen to draw on",
            getenv("TERM") ? getenv("TERM") : "");
    signal(SIGPIPE, SIG_IGN);       /* when a lost coordinator is written to */
    sigaction(SIGINT, &stop, NULL); /* ncurses' handler would end us */
    sigaction(SIGQUIT, &stop, NULL);
    sigaction(SIGTERM, &stop, NULL);
    sigaction(SIGHUP, &stop, NULL);
    cbreak();
    noecho();
    keypad(stdscr, TRUE);
    set_escdelay(ESCAPE_MS);
    timeout(0);
    curs_set(0);
    if (colours_wanted()) {
        start_color();
        use_default_colors();
        init_pair(PAIR_TITLE, COLOR_CYAN, -1);
        init_pair(PAIR_WARNING, COLOR_YELLOW, -1);
    }
    return 0;
}

static void
close_terminal(struct screen *s)
{
    if (!s->curses)
        return;
    endwin();
    delscreen(s->curses);
    s->curses = NULL;
}

/* The attribute for a look, without colours if the user wants none. */
static attr_t
attribute(enum top_look look)
{
    bool colours = colours_wanted();

    switch (look) {
    case TOP_TITLE:
        return colours ? COLOR_PAIR(PAIR_TITLE) : A_NORMAL;
    case TOP_WARNING:
        return A_BOLD | (colours ? COLOR_PAIR(PAIR_WARNING) : A_NORMAL);
    case TOP_HEAD:
        return A_BOLD | A_UNDERLINE;
    case TOP_CHOSEN:
        return A_REVERSE;
    default:
        return A_NORMAL;
    }
}

static void
put_line(void *arg, int line, enum top_look look, const char *text)
{
    (void)arg;
    attrset(attribute(look));
    mvaddstr(line, 0, text);
    attrset(A_NORMAL);
}

static void
draw(struct screen *s)
{
    erase();
    top_draw(&s->top, COLS, LINES, put_line, NULL);
    refresh();
}

static int
key_of(int key)
{
    switch (key) {
    case KEY_UP:
    case 'k':
        return TOP_KEY_UP;
    case KEY_DOWN:
    case 'j':
        return TOP_KEY_DOWN;
    case KEY_PPAGE:
        return TOP_KEY_PAGE_UP;
    case KEY_NPAGE:
        return TOP_KEY_PAGE_DOWN;
    case KEY_ENTER:
    case '\n':
    case '\r':
        return TOP_KEY_ENTER;
    case 27:
        return TOP_KEY_BACK;
    case KEY_BACKSPACE:
    case 127:
    case '\b':
        return TOP_KEY_ERASE;
    default:
        return key;
    }
}

/* The key in top.h's terms; in the filter 'j' and 'k' are letters. */
static int
key_in(const struct screen *s, int key)
{
    return s->top.editing && (key == 'j' || key == 'k') ? key : key_of(key);
}

/* Handle all waiting keys; false: the user quits. */
static bool
take_keys(struct screen *s)
{
    int key;

    while ((key = getch()) != ERR) {
        enum top_wish wish =
            key == KEY_RESIZE ? TOP_NOTHING : top_key(&s->top, key_in(s, key));

        if (wish == TOP_QUIT)
            return false;
        if (wish == TOP_LOOK)
            s->due_ms = 0;
        else if (wish != TOP_NOTHING)
            carry_out(s, wish);
    }
    return true;
}

/* Wait for a key, a signal (as of the window's size) or the next request. */
static bool
wait_for_keys(struct screen *s)
{
    struct pollfd in = { .fd = STDIN_FILENO, .events = POLLIN };
    uint64_t t = now_ms(s->c);

    if (t < s->due_ms)
        poll(&in, 1, (int)(s->due_ms - t));
    /* end if the terminal is gone, instead of looping without rest */
    return !(in.revents & (POLLHUP | POLLERR | POLLNVAL)) && take_keys(s);
}

/* --json: print once what the screen is made of. */
static int
print_once(struct ctl *c)
{
    json_t *status = NULL, *workers = NULL, *jobs = NULL, *root;
    const struct msg *answer;
    int rc = ctl_query(c, MSG_QUERY_STATUS, NULL, &answer);

    if (rc == 0 && !(status = ctl_parse(c, answer)))
        rc = c->err->code;
    if (rc == 0)
        rc = ask_rows(c, 0, false, &workers, &jobs);
    if (rc == 0) {
        root = json_pack("{s:O,s:O,s:o}", "status", status, "workers", workers,
                         "jobs", lists_served(jobs));
        table_print_json(stdout, root);
        json_decref(root);
    }
    json_decref(status);
    json_decref(workers);
    json_decref(jobs);
    return rc;
}

int
ctl_check_top(struct ctl *c)
{
    if (c->json || (isatty(STDOUT_FILENO) && isatty(STDIN_FILENO)))
        return 0;
    return rad_fail(c->err, RAD_EUSAGE,
                    "top is for a terminal; with --json it is for programs, as "
                    "are status, workers, jobs and job");
}

int
ctl_run_top(struct ctl *c)
{
    struct screen s = { .c = c };
    int rc;

    if (c->json)
        return print_once(c);
    rc = open_terminal(&s);
    if (rc < 0)
        return rc;
    top_init(&s.top);
    do {
        if (now_ms(c) >= s.due_ms)
            refresh_data(&s);
        draw(&s);
    } while (!stopped && wait_for_keys(&s) && !stopped);
    close_terminal(&s);
    top_release(&s.top);
    return 0;
}
