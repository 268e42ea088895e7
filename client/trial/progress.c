/* progress.c - see progress.h */
#include "config.h"

#include "trial/progress.h"

#include "base/number.h"

#include <limits.h>
#include <math.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* long enough to smooth the lumps in which rays are reported */
#define RATE_TIME_CONSTANT_S 4.0

void
progress_init(struct progress *p, FILE *to, enum submit_progress when)
{
    memset(p, 0, sizeof *p);
    p->terminal = isatty(fileno(to)) == 1;
    if (when == PROGRESS_ALWAYS || (when == PROGRESS_AUTO && p->terminal))
        p->to = to;
    p->last_s = p->said_s = -1;
}

void
progress_every(struct progress *p, FILE *to, double every_s)
{
    p->to = to;
    p->terminal = false;
    p->every_s = every_s;
}

/* Is it too soon for another line? */
static bool
too_soon(struct progress *p, double now_s)
{
    double since_s = p->said_s < 0 ? now_s : now_s - p->said_s;

    /* reports come about half a second apart; a job may begin again */
    if (since_s >= 0 && since_s < p->every_s - .25)
        return true;
    p->said_s = now_s;
    return false;
}

static void
format_left(char *buf, size_t size, double s)
{
    long t;

    if (!(s > 0) || s > 3.6e8) /* over 100 000 hours: not known */
        return;
    t = lround(s);
    if (t < 3600)
        snprintf(buf, size, "  %ld:%02ld left", t / 60, t % 60);
    else
        snprintf(buf, size, "  %ld:%02ld:%02ld left", t / 3600, t / 60 % 60,
                 t % 60);
}

void
progress_format(char *buf, size_t size, const struct progress_report *r,
                double rays_per_s)
{
    char rate[RAD_NUMBER_TEXT + 10] = "", left[40] = "";
    char workers[40] = "  no worker", brief[RAD_NUMBER_TEXT];
    double done = r->done < 0 ? 0 : r->done > 1 ? 1 : r->done;
    bool over = done >= 1, working = r->workers > 0;

    if (r->rays > 0 && (working || over)) {
        rad_format_brief(brief, rays_per_s);
        snprintf(rate, sizeof rate, "  %s rays/s", brief);
    }
    if (working && !over)
        format_left(left, sizeof left, r->left_s);
    if (over)
        workers[0] = '\0'; /* workers have gone on to other jobs */
    else if (working)
        snprintf(workers, sizeof workers, "  %d worker%s", r->workers,
                 r->workers == 1 ? "" : "s");
    /* rounded down, so 100 % means done */
    snprintf(buf, size, "%3d %%%s%s%s", (int)(done * 100), rate, left, workers);
}

static void
take_rate(struct progress *p, const struct progress_report *r)
{
    double dt = r->elapsed_s - p->last_s, keep;

    if (p->last_s < 0 || p->last_rays == 0) {
        /* rays are reported per unit: the first were made over all that time */
        p->rate = r->elapsed_s > 0 ? (double)r->rays / r->elapsed_s : 0;
    } else if (r->rays < p->last_rays) {
        p->rate = 0; /* the job began again */
    } else if (dt > 0) {
        keep = exp(-dt / RATE_TIME_CONSTANT_S);
        p->rate =
            keep * p->rate + (1 - keep) * (double)(r->rays - p->last_rays) / dt;
    } else {
        return;
    }
    p->last_s = r->elapsed_s;
    p->last_rays = r->rays;
}

/* The columns that a line may take: it must not wrap, or the next one could not
 * take its place.  Of a terminal that does not know its width, any. */
static int
room(FILE *to)
{
    struct winsize size;

    return ioctl(fileno(to), TIOCGWINSZ, &size) == 0 && size.ws_col > 1
               ? size.ws_col - 1
               : INT_MAX;
}

/* Write over the line that is shown, with blanks and no control sequence, which
 * not every terminal obeys. */
static void
show_in_place(struct progress *p, const char *line)
{
    int most = room(p->to), n = (int)strlen(line);

    n = n < most ? n : most;
    p->shown = p->shown < most ? p->shown : most;
    fprintf(p->to, "\r%.*s", n, line);
    if (p->shown > n)
        fprintf(p->to, "%*s\r%.*s", p->shown - n, "", n, line);
    p->shown = n;
}

void
progress_update(struct progress *p, const struct progress_report *r)
{
    char line[160];

    if (!p->to)
        return;
    take_rate(p, r);
    if (r->done >= 1 && r->elapsed_s > 0) /* the job is done: show the mean */
        p->rate = (double)r->rays / r->elapsed_s;
    if (too_soon(p, r->elapsed_s))
        return;
    progress_format(line, sizeof line, r, p->rate);
    if (p->terminal)
        show_in_place(p, line);
    else
        fprintf(p->to, "%s\n", line);
    fflush(p->to);
}

double
progress_alone(struct progress_alone *a, const struct progress_report *r,
               bool working)
{
    double since_s = r->elapsed_s - a->last_s;

    since_s = since_s < 0 ? 0 : since_s > 1 ? 1 : since_s;
    a->last_s = r->elapsed_s;
    a->for_s = working && r->workers == 0 ? a->for_s + since_s : 0;
    return a->for_s;
}

void
progress_clear(struct progress *p)
{
    if (p->shown == 0)
        return;
    show_in_place(p, "");
    fflush(p->to);
}
