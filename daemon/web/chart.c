/* chart.c - see chart.h */
#include "config.h"

#include "web/chart.h"

#include <math.h>

#define WIDTH  720 /* of the drawings, in their own units */
#define HEIGHT 100

/* --- the last hour --- */

static double
most_rays(const struct history *h)
{
    double most = 0;

    for (unsigned i = 0; i < HISTORY_POINTS; i++)
        if (history_at(h, i)->rays_s > most)
            most = history_at(h, i)->rays_s;
    return most;
}

/* 1, 2, 5 or 10 times a power of ten, not below v. */
static double
round_up(double v)
{
    double p = v > 0 ? pow(10, floor(log10(v))) : 1;

    return v <= p ? p : v <= 2 * p ? 2 * p : v <= 5 * p ? 5 * p : 10 * p;
}

/* A line through the points that are known, broken where none is. */
static void
put_line(struct markup *m, const struct history *h, bool rays, double top)
{
    const double step = (double)WIDTH / (HISTORY_POINTS - 1);
    bool on = false;

    markup_print(m, "<path class=\"%s\" d=\"", rays ? "line" : "line2");
    for (unsigned i = HISTORY_POINTS; i-- > 0;) {
        const struct history_point *p = history_at(h, i);
        double x = WIDTH - i * step;

        if (p->notes > 0)
            markup_print(m, "%c%.1f %.1f", on ? 'L' : 'M', x,
                         HEIGHT -
                             (rays ? p->rays_s : p->at_work) / top * HEIGHT);
        if (p->notes > 0 && !on) /* a point alone is seen, too */
            markup_print(m, "h.1");
        on = p->notes > 0;
    }
    markup_raw(m, "\"/>");
}

static void
put_chart(struct markup *m, const struct history *h, bool rays, double top)
{
    markup_print(m,
                 "<svg class=\"chart\" viewBox=\"0 0 %d %d\" "
                 "preserveAspectRatio=\"none\" role=\"img\" "
                 "aria-label=\"%s in the last hour\">",
                 WIDTH, HEIGHT, rays ? "rays a second" : "threads at work");
    for (int i = 0; i <= 4; i++)
        markup_print(m, "<path class=\"%s\" d=\"M0 %dH%d\"/>",
                     i == 4 ? "axis" : "grid", i * HEIGHT / 4, WIDTH);
    put_line(m, h, rays, top);
    markup_raw(m, "</svg>");
}

static void
put_times(struct markup *m)
{
    markup_raw(m, "<div class=\"times\"><span>1 h ago</span>"
                  "<span>45 min</span><span>30 min</span><span>15 min</span>"
                  "<span>now</span></div>");
}

void
chart_history(struct markup *m, const struct history *h)
{
    double top = round_up(most_rays(h));

    markup_raw(m,
               "<figure><figcaption>Rays a second <span class=\"dim\">0 to ");
    markup_count(m, top);
    markup_raw(m, "</span></figcaption>");
    put_chart(m, h, true, top);
    put_times(m);
    markup_raw(m, "</figure><figure><figcaption>Threads at work <span "
                  "class=\"dim\">0 to 100 % of those that are there</span>"
                  "</figcaption>");
    put_chart(m, h, false, 1);
    put_times(m);
    markup_raw(m, "</figure>");
}

/* --- units by worker --- */

#define LANE 8 /* height of a lane */

static void
put_span(struct markup *m, const struct units *u, const struct units_span *s)
{
    double all = u->end_s - u->start_s;
    double x = (s->start - u->start_s) / all * WIDTH;
    double w = (s->end - s->start) / all * WIDTH;

    markup_print(m,
                 "<rect%s x=\"%.2f\" y=\"%d\" width=\"%.2f\" height=\"%d\">"
                 "<title>",
                 s->kind == UNITS_RUN ? " class=\"runs\"" : "", x,
                 s->lane * LANE + 1, w > .8 ? w - .4 : .6, LANE - 2);
    markup_print(m, "%u %s%s, %.3g s to ", s->units,
                 s->kind == UNITS_PASS ? "pass" : "unit",
                 s->units == 1           ? ""
                 : s->kind == UNITS_PASS ? "es"
                                         : "s",
                 s->start);
    if (s->kind == UNITS_RUN)
        markup_raw(m, "now, at work</title></rect>");
    else
        markup_print(m, "%.3g s</title></rect>", s->end);
}

/* One worker's row; returns the first span that is another's. */
static size_t
put_worker(struct markup *m, const struct units *u, size_t worker, size_t i)
{
    /* those who hear the page have the table of the job's workers */
    markup_raw(m, "<div class=\"gantt\" aria-hidden=\"true\">"
                  "<span class=\"name\">");
    markup_text(m, i < u->nspans && u->spans[i].kind == UNITS_PASS
                       ? "(passes)"
                       : u->workers[worker]);
    markup_print(m,
                 "</span><svg viewBox=\"0 0 %d %d\" height=\"%d\" "
                 "preserveAspectRatio=\"none\">",
                 WIDTH, u->lanes[worker] * LANE,
                 u->lanes[worker] > 2 ? u->lanes[worker] * LANE
                                      : u->lanes[worker] * LANE * 2);
    for (; i < u->nspans && u->spans[i].worker == worker; i++)
        put_span(m, u, &u->spans[i]);
    markup_raw(m, "</svg></div>");
    return i;
}

static bool
has_runs(const struct units *u)
{
    for (size_t i = 0; i < u->nspans; i++)
        if (u->spans[i].kind == UNITS_RUN)
            return true;
    return false;
}

void
chart_units(struct markup *m, const struct units *u)
{
    size_t i = 0;

    if (u->nspans == 0 || !(u->end_s > u->start_s)) {
        markup_raw(m, "<p class=\"empty\">No unit is begun yet.</p>");
        return;
    }
    for (size_t k = 0; k < u->nworkers; k++)
        i = put_worker(m, u, k, i);
    markup_raw(m, "<div class=\"gantt\" aria-hidden=\"true\">"
                  "<span class=\"name\"></span><div class=\"times\"><span>");
    markup_span(m, u->start_s);
    markup_raw(m, "</span><span>");
    markup_span(m, (u->start_s + u->end_s) / 2);
    markup_raw(m, "</span><span>");
    markup_span(m, u->end_s);
    markup_raw(m, "</span></div></div>");
    if (has_runs(u))
        markup_raw(m, "<p class=\"dim\" aria-hidden=\"true\">Units that are at "
                      "work are drawn hollow.</p>");
}
