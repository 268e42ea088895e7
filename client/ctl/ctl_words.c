/* ctl_words.c - radctl's answers about one thing, for people
 *
 * Members of the coordinator's JSON (see radd.stats(5)) become lines of a name
 * and a value with its unit.  Values that tell nothing are left out, such as 0
 * repeated units or an exit status of success. */
#include "config.h"

#include "ctl/ctl.h"
#include "ctl/row.h"
#include "common/figure.h"
#include "common/tell.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { NAME_COLUMNS = sizeof "ambient cache" - 1 };

static void
put(FILE *to, const char *name, const char *value)
{
    tell(to, "%-*s  %s", NAME_COLUMNS, name, value);
}

static void
put_text(FILE *to, const json_t *root, const char *key, const char *name)
{
    const char *text = row_text(root, key);

    if (text[0])
        put(to, name, text);
}

const char *
ctl_span(char text[CTL_SPAN], double s)
{
    char figures[FIGURE_TEXT];
    double min = floor(s / 60), h = floor(min / 60), days = floor(h / 24);

    if (s < 60)
        snprintf(text, CTL_SPAN, "%s s", figure(figures, s, 2));
    else if (h < 1)
        snprintf(text, CTL_SPAN, "%.0f min", min);
    else if (days < 1)
        snprintf(text, CTL_SPAN, "%.0f h %.0f min", h, min - 60 * h);
    else
        snprintf(text, CTL_SPAN, "%.0f day%s %.0f h", days, row_plural(days),
                 h - 24 * days);
    return text;
}

/* --- status --- */

/* The time when this life of the coordinator began. */
static void
put_start(FILE *to, double start_ms)
{
    time_t s = (time_t)(start_ms / 1000);
    char at[40], ago[CTL_SPAN], line[100];
    struct tm tm;

    if (!(start_ms > 0) || start_ms > 1e15 || !localtime_r(&s, &tm) ||
        strftime(at, sizeof at, "%Y-%m-%d %H:%M:%S", &tm) == 0)
        return;
    snprintf(line, sizeof line, "%s, %s ago", at,
             ctl_span(ago, fmax(0, difftime(time(NULL), s))));
    put(to, "since", line);
}

/* Drained workers are counted apart, for they get no work. */
static void
put_workers(FILE *to, const json_t *status)
{
    double drained = row_number(status, "drained");
    double workers = row_number(status, "workers") - drained;
    double threads =
        row_number(status, "threads") - row_number(status, "drained_threads");
    char line[100] = "none", rest[40] = "";

    if (workers > 0)
        snprintf(line, sizeof line, "%.0f, with %.0f thread%s", workers,
                 threads, row_plural(threads));
    if (drained > 0)
        snprintf(rest, sizeof rest, " (%.0f drained)", drained);
    tell(to, "%-*s  %s%s", NAME_COLUMNS, "workers", line, rest);
}

void
ctl_tell_status(FILE *to, const json_t *status)
{
    double jobs = row_number(status, "jobs");
    double kept = row_number(status, "jobs_kept") - jobs;
    double slow = row_number(status, "slow_turns");
    char line[200], worst[FIGURE_TEXT];

    put_text(to, status, "program", "program");
    put_start(to, row_number(status, "start_ms"));
    put_workers(to, status);
    snprintf(line, sizeof line, "%.0f open, %.0f over and kept", jobs,
             fmax(0, kept));
    put(to, "jobs", line);
    if (json_is_true(json_object_get(status, "disk_full")))
        put(to, "disk", "full: jobs are held until there is room");
    if (slow > 0) {
        snprintf(line, sizeof line,
                 "everybody had to wait %.0f time%s, for %s ms at most", slow,
                 row_plural(slow),
                 figure(worst, row_number(status, "longest_turn_ms"), 2));
        put(to, "delays", line);
    }
}

/* --- job --- */

static void
put_picture(FILE *to, const json_t *job)
{
    double frames = row_number(job, "frames");
    double n = row_number(job, "oversample");
    char line[200], from[60] = "", many[80] = "";

    if (n > 1)
        snprintf(from, sizeof from, " of %.0f x %.0f samples a pixel", n, n);
    if (frames > 1)
        snprintf(many, sizeof many, "%.0f frames (%.0f ready) of ", frames,
                 row_number(job, "frames_ready"));
    snprintf(line, sizeof line, "%s%.0f x %.0f%s", many,
             row_number(job, "width"), row_number(job, "height"), from);
    put(to, "picture", line);
}

/* For jobs with --error or --time. */
static void
put_goal(FILE *to, const json_t *job)
{
    double error = row_number(job, "goal_error");
    double time = row_number(job, "goal_time_s");
    double now = row_number(job, "estimated_error");
    char line[200], by[FIGURE_TEXT], wanted[60] = "", within[60] = "";

    if (error <= 0 && time <= 0)
        return;
    if (error > 0)
        snprintf(wanted, sizeof wanted, "error of %s %%",
                 figure(by, 100 * error, 3));
    if (time > 0)
        snprintf(within, sizeof within, "%s%s s", error > 0 ? ", within " : "",
                 figure(by, time, 3));
    snprintf(line, sizeof line, "%s%s", wanted, within);
    put(to, "asked for", line);
    snprintf(line, sizeof line, "%.0f of at most %.0f%s%s%s",
             row_number(job, "stage"), row_number(job, "stages"),
             now > 0 ? ", estimated error " : "",
             now > 0 ? figure(by, 100 * now, 2) : "", now > 0 ? " %" : "");
    put(to, "stage", line);
}

/* The work so far. */
static void
put_work(FILE *to, const json_t *job)
{
    double rays = row_number(job, "rays");
    double again = row_number(job, "units_redone");
    char line[200], time[CTL_SPAN], millions[FIGURE_TEXT];

    snprintf(line, sizeof line, "%s since it was submitted",
             ctl_span(time, row_number(job, "elapsed_s")));
    put(to, "time", line);
    if (json_object_get(job, "left_s")) {
        snprintf(line, sizeof line, "about %s",
                 ctl_span(time, row_number(job, "left_s")));
        put(to, "left", line);
    }
    if (rays > 0) {
        snprintf(line, sizeof line, "%s million",
                 figure(millions, rays / 1e6, 3));
        put(to, "rays", line);
    }
    if (again > 0) {
        snprintf(line, sizeof line, "%.0f part%s of the picture, after a loss",
                 again, row_plural(again));
        put(to, "made again", line);
    }
}

/* The ambient cache that the job began with, and the one that is kept of it. */
static void
put_reuse(FILE *to, const json_t *job)
{
    double bytes = row_number(job, "cache_bytes");
    char line[80], size[FIGURE_TEXT];

    if (row_text(job, "reuse")[0]) {
        snprintf(line, sizeof line, "begins with that of %s",
                 row_text(job, "reuse"));
        put(to, "ambient cache", line);
    }
    if (bytes > 0) {
        snprintf(line, sizeof line, "%s MB kept for --reuse",
                 figure(size, bytes / 1e6, 3));
        put(to, "ambient cache", line);
    }
}

void
ctl_tell_job(FILE *to, const json_t *job)
{
    double status = row_number(job, "status");
    char line[40];

    put_text(to, job, "job", "job");
    put_text(to, job, "name", "name");
    put_text(to, job, "owner", "owner");
    put_text(to, job, "state", "state");
    if (strcmp(row_text(job, "text"), row_text(job, "state")) != 0)
        put_text(to, job, "text", "note");
    if (status != 0) {
        snprintf(line, sizeof line, "%.0f", status);
        put(to, "exit status", line);
    }
    /* rounded down, so 100 % means done */
    snprintf(line, sizeof line, "%.0f %%",
             floor(100 * row_number(job, "done")));
    put(to, "done", line);
    if (row_number(job, "passes") > 0) {
        snprintf(line, sizeof line, "pass %.0f of %.0f, %.0f %%",
                 row_number(job, "pass"), row_number(job, "passes"),
                 floor(100 * row_number(job, "pass_done")));
        put(to, "ambient cache", line);
    }
    put_reuse(to, job);
    put_goal(to, job);
    put_picture(to, job);
    snprintf(line, sizeof line, "%.0f", row_number(job, "workers"));
    put(to, "workers", line);
    snprintf(line, sizeof line, "%.0f", row_number(job, "priority"));
    put(to, "priority", line);
    put_work(to, job);
}
