/* top_lines.c - radctl top as lines of text; see top.h
 *
 * The columns of a list have ranks: on a narrow terminal those of the highest
 * rank are left out first.  The column marked `wide` gets the width that is
 * left. */
#include "config.h"

#include "ctl/top.h"

#include "ctl/row.h"
#include "ctl/top_rows.h"

#include "base/text.h"
#include "common/figure.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDEST = 500, GAP = 2, CELL = 200, GANTT_LEFT = 46 };

/* --- cells --- */

static const char *const thousands[] = { "", " k", " M", " G", " T" };
static const char *const binary[] = { " B", " KiB", " MiB", " GiB", " TiB" };

/* Write 1234567 as "1.2 M". */
static void
scaled(char *text, double x, double step, const char *const units[5])
{
    char digits[FIGURE_TEXT];
    int i = 0;

    while (x >= step && i < 4) {
        x /= step;
        i++;
    }
    snprintf(text, CELL, "%s%s", figure(digits, x, x < 10 ? 2 : 3), units[i]);
}

static void
span(char *text, double s)
{
    if (s < 60)
        snprintf(text, CELL, "%.0f s", s);
    else if (s < 3600)
        snprintf(text, CELL, "%.0f:%02.0f", floor(s / 60), floor(fmod(s, 60)));
    else if (s < 86400)
        snprintf(text, CELL, "%.0f h %02.0f", floor(s / 3600),
                 floor(fmod(s, 3600) / 60));
    else
        snprintf(text, CELL, "%.0f days", floor(s / 86400));
}

static void
cell(const struct top *t, enum top_pane pane, const struct top_column *c,
     const json_t *row, char text[CELL])
{
    double x = top_value(t, pane, c, row);

    text[0] = '\0';
    if (c->kind == TOP_TEXT || c->kind == TOP_ID)
        rad_text_print(text, CELL, "%.*s", c->kind == TOP_ID ? 8 : CELL - 1,
                       row_text(row, c->key));
    else if (c->kind == TOP_COUNT && json_object_get(row, c->key))
        snprintf(text, CELL, "%.0f", row_number(row, c->key));
    else if (c->kind == TOP_LOAD && x >= 0)
        snprintf(text, CELL, "%.*f", x < 99.5 ? 1 : 0, x);
    else if (c->kind == TOP_OF && x >= 0)
        snprintf(text, CELL, "%.0f/%.0f", x, row_number(t->status, "workers"));
    else if (c->kind == TOP_PASS && x > 0)
        snprintf(text, CELL, "%.0f/%.0f", x, row_number(row, "passes"));
    else if ((c->kind == TOP_RATE || c->kind == TOP_MANY) && x >= 0)
        scaled(text, x, 1000, thousands);
    else if (c->kind == TOP_BYTES && x > 0)
        scaled(text, x, 1024, binary);
    else if (c->kind == TOP_SHARE && x >= 0)
        snprintf(text, CELL, "%.0f %%", floor(100 * x));
    else if (c->kind == TOP_SMALL && x > 0)
        snprintf(text, CELL, "%.1f %%", 100 * x);
    else if (c->kind == TOP_SPAN && x >= 0)
        span(text, x);
}

/* --- lines --- */

struct line {
    char text[4 * WIDEST + 1];
    size_t len;
};

/* Put a text in exactly `width` columns: cut it, or fill it up with blanks. */
static void
put_cell(struct line *l, const char *text, size_t width, bool right)
{
    char kept[CELL];
    size_t used, pad;

    rad_text_print(kept, sizeof kept, "%s", text);
    rad_text_clean(kept);
    kept[rad_text_fit(kept, width)] = '\0';
    used = rad_text_width(kept);
    pad = used < width ? width - used : 0;
    if (l->len + strlen(kept) + pad + GAP + 1 > sizeof l->text)
        return;
    l->len +=
        (size_t)sprintf(l->text + l->len, "%*s%s%*s", right ? (int)pad : 0, "",
                        kept, right ? 0 : (int)pad, "");
}

static void
put_gap(struct line *l)
{
    if (l->len > 0 && l->len + GAP < sizeof l->text)
        l->len += (size_t)sprintf(l->text + l->len, "%*s", GAP, "");
}

/* The highest rank up to which all columns fit; *extra: width for the wide one.
 */
static int
fit_ranks(enum top_pane pane, int width, int *extra)
{
    const struct top_column *c = top_columns(pane);
    int n = top_ncolumns(pane);

    for (int rank = 9; rank >= 0; rank--) {
        int need = -GAP;

        for (int i = 0; i < n; i++)
            if (c[i].rank <= rank)
                need += c[i].width + GAP;
        *extra = width - need;
        if (need <= width)
            return rank;
    }
    *extra = 0;
    return 0;
}

/* A row of a list; row NULL: the titles. */
static void
list_line(const struct top *t, enum top_pane pane, const json_t *row, int width,
          struct line *l)
{
    const struct top_list *list = &t->list[pane];
    int extra, rank = fit_ranks(pane, width, &extra);

    *l = (struct line){ .len = 0 };
    for (int i = 0; i < top_ncolumns(pane); i++) {
        const struct top_column *c = &top_columns(pane)[i];
        char text[CELL];

        if (c->rank > rank)
            continue;
        if (row)
            cell(t, pane, c, row, text);
        else
            snprintf(text, sizeof text, "%s%s", c->title,
                     i != list->sort ? ""
                     : list->back    ? "^"
                                     : "v");
        put_gap(l);
        put_cell(l, text, (size_t)(c->width + (c->wide ? extra : 0)),
                 c->kind != TOP_TEXT && c->kind != TOP_ID);
    }
    l->text[rad_text_fit(l->text, (size_t)width)] = '\0';
}

struct screen {
    const struct top *t;
    int columns, lines, at; /* at: the next line */
    top_put_fn *put;
    void *arg;
};

static void
put_text(struct screen *s, int line, enum top_look look, const char *text)
{
    char cut[4 * WIDEST + 1];

    if (line < 0 || line >= s->lines)
        return;
    rad_text_print(cut, sizeof cut, "%s", text);
    rad_text_clean(cut);
    cut[rad_text_fit(cut, (size_t)s->columns)] = '\0';
    s->put(s->arg, line, look, cut);
}

static void __attribute__((format(printf, 3, 4)))
say(struct screen *s, enum top_look look, const char *fmt, ...)
{
    char text[WIDEST];
    va_list ap;

    va_start(ap, fmt);
    rad_text_vprint(text, sizeof text, fmt, ap);
    va_end(ap);
    put_text(s, s->at++, look, text);
}

/* --- the lists --- */

static double
total_rate(const struct top *t)
{
    const char *name;
    json_t *rate;
    double sum = 0;

    json_object_foreach(t->list[TOP_JOBS].rates, name, rate)
    {
        sum += json_number_value(rate);
    }
    return sum;
}

static void
draw_summary(struct screen *s)
{
    const struct top *t = s->t;
    double workers = row_number(t->status, "workers");
    double threads = row_number(t->status, "threads");
    double jobs = row_number(t->status, "jobs");
    char rate[CELL];

    scaled(rate, total_rate(t), 1000, thousands);
    if (t->status)
        say(s, TOP_TITLE,
            "%s   %.0f worker%s, %.0f thread%s   %.0f job%s   %s rays/s",
            row_text(t->status, "program"), workers, row_plural(workers),
            threads, row_plural(threads), jobs, row_plural(jobs), rate);
    else
        say(s, TOP_TITLE, "radctl top");
    if (t->editing || (t->filter[0] && !t->note[0]))
        say(s, TOP_WARNING, "filter: %s%s", t->filter, t->editing ? "_" : "");
    else
        say(s, TOP_WARNING, "%s", t->note);
}

/* Draw up to `room` rows of a list, among them the chosen one. */
static void
draw_list(struct screen *s, enum top_pane pane, const json_t **v, size_t n,
          int room)
{
    const char *chosen = top_name(pane, top_chosen(s->t, pane));
    long first, at = (long)top_place(v, n, pane, chosen);
    struct line l;

    if (room < 2)
        return;
    list_line(s->t, pane, NULL, s->columns, &l);
    put_text(s, s->at++, TOP_HEAD, l.text);
    first = at - (room - 1) / 2;
    if (first > (long)n - (room - 1))
        first = (long)n - (room - 1);
    first = first < 0 ? 0 : first;
    for (long i = first; i < (long)n && i < first + room - 1; i++) {
        list_line(s->t, pane, v[i], s->columns, &l);
        put_text(s, s->at++,
                 i == at && pane == s->t->pane ? TOP_CHOSEN : TOP_PLAIN,
                 l.text);
    }
}

static void
draw_lists(struct screen *s)
{
    size_t n[TOP_NPANE];
    const json_t **v[TOP_NPANE];
    int body, room[TOP_NPANE];

    draw_summary(s);
    body = s->lines - s->at - 2; /* below: an empty line, and the keys */
    for (int p = 0; p < TOP_NPANE; p++)
        v[p] = top_rows(s->t, (enum top_pane)p, &n[p]);
    for (int p = 0; p < TOP_NPANE; p++)
        room[p] = n[p] + 1 < WIDEST ? (int)n[p] + 1 : WIDEST;
    if (body < 8) { /* too few lines for two lists */
        room[s->t->pane] = body + 1;
        room[1 - s->t->pane] = 0;
    } else if (room[0] + room[1] > body) {
        if (room[0] > body / 2)
            room[0] = room[1] > body - body / 2 ? body / 2 : body - room[1];
        room[1] = body - room[0];
    }
    for (int p = 0; p < TOP_NPANE; p++) {
        if (v[p])
            draw_list(s, (enum top_pane)p, v[p], n[p], room[p]);
        if (p == 0 && room[0] > 0)
            s->at++;
        free(v[p]);
    }
    put_text(s, s->lines - 1, TOP_TITLE,
             "q quit  Tab list  Enter job  s sort  r reverse  / filter  "
             "c cancel  p pause  d drain  a all");
}

/* --- one job --- */

/* Draw the units of a worker over the job's time; neighbours get the two
 * characters of `turns` by turns. */
static void
put_spans(const json_t *units, const char *worker, double end_s,
          const char turns[2], char *bar, int n)
{
    const json_t *u;
    size_t i;
    int turn = 0;

    json_array_foreach(units, i, u)
    {
        double from = row_number(u, "start_s"), to = row_number(u, "end_s");
        int a, b;

        if (strcmp(row_text(u, "worker"), worker) != 0 || !(end_s > 0) ||
            !(from >= 0) || !(from <= end_s))
            continue;
        a = (int)(from / end_s * n);
        b = to >= from && to <= end_s ? (int)ceil(to / end_s * n) : n;
        a = a < n ? a : n - 1;
        b = b > a ? b : a + 1;
        memset(bar + a, turns[turn++ % 2], (size_t)(b - a));
    }
}

static void
gantt(const json_t *stats, const char *worker, double end_s, char *bar, int n)
{
    memset(bar, '.', (size_t)n);
    bar[n] = '\0';
    put_spans(json_object_get(stats, "running"), worker, end_s, ">>", bar, n);
    put_spans(json_object_get(stats, "units"), worker, end_s, "#=", bar, n);
}

static double
job_end(const json_t *stats)
{
    const json_t *u;
    double end = row_number(json_object_get(stats, "time"), "wall_s");
    size_t i;

    json_array_foreach(json_object_get(stats, "units"), i, u)
    {
        if (row_number(u, "end_s") > end)
            end = row_number(u, "end_s");
    }
    u = json_array_get(json_object_get(stats, "running"), 0);
    return row_number(u, "end_s") > end ? row_number(u, "end_s") : end;
}

static void
draw_worker(struct screen *s, const json_t *w, double end_s)
{
    int n = s->columns - GANTT_LEFT;
    char rays[CELL], memory[CELL], bar[WIDEST + 1] = "", units[CELL];
    struct line l = { .len = 0 };

    scaled(rays, row_number(w, "rays") + row_number(w, "rays_under_way"), 1000,
           thousands);
    scaled(memory, row_number(w, "peak_rss_bytes"), 1024, binary);
    snprintf(units, sizeof units, "%.0f", row_number(w, "units"));
    put_cell(&l, row_text(w, "name"), 16, false);
    put_gap(&l);
    put_cell(&l, units, 5, true);
    put_gap(&l);
    put_cell(&l, rays, 7, true);
    put_gap(&l);
    put_cell(&l, memory, 8, true);
    put_gap(&l);
    if (n > 0)
        gantt(s->t->stats, row_text(w, "name"), end_s, bar,
              n < WIDEST ? n : WIDEST);
    say(s, TOP_PLAIN, "%s%s", l.text, bar);
}

/* The passes of the ambient cache, above the units. */
static void
draw_passes(struct screen *s, double end_s)
{
    const json_t *passes = json_object_get(s->t->stats, "passes");
    int n = s->columns - GANTT_LEFT;
    char bar[WIDEST + 1] = "";

    if (json_array_size(passes) == 0 || n <= 0)
        return;
    memset(bar, '.', (size_t)n);
    bar[n] = '\0';
    put_spans(passes, "", end_s, "#=", bar, n);
    say(s, TOP_PLAIN, "%-*s%s", GANTT_LEFT, "passes of the ambient cache", bar);
}

static void
draw_workers(struct screen *s)
{
    const json_t *workers = json_object_get(s->t->stats, "workers");
    double end_s = job_end(s->t->stats);
    int most = (int)json_array_size(workers) - 1;
    int first = s->t->scroll < most ? s->t->scroll : most;
    char end[CELL];

    span(end, end_s);
    say(s, TOP_HEAD, "%-16s  %5s  %7s  %8s  UNITS FROM 0 TO %s", "WORKER",
        "UNITS", "RAYS", "MEMORY", end);
    draw_passes(s, end_s);
    for (int i = first < 0 ? 0 : first; i <= most && s->at < s->lines - 1; i++)
        draw_worker(s, json_array_get(workers, (size_t)i), end_s);
}

static void
draw_progress(struct screen *s, const json_t *row)
{
    const json_t *totals = json_object_get(s->t->stats, "totals");
    char left[CELL] = "", error[CELL] = "", pass[CELL] = "";

    if (row_number(row, "left_s") > 0)
        span(left, row_number(row, "left_s"));
    if (row_number(row, "error") > 0)
        snprintf(error, sizeof error, ", error about %.1f %%",
                 100 * row_number(row, "error"));
    if (row_number(row, "pass") > 0)
        snprintf(pass, sizeof pass, ", pass %.0f of %.0f to %.0f %%",
                 row_number(row, "pass"), row_number(row, "passes"),
                 100 * row_number(row, "pass_done"));
    say(s, TOP_PLAIN, "%s, %.0f %% done%s%s%s%s", row_text(row, "state"),
        floor(100 * row_number(row, "done")), left[0] ? ", left " : "", left,
        pass, error);
    say(s, TOP_PLAIN,
        "%.0f of %.0f units, %.0f done again; %.0f ambient values, %.0f "
        "redundant",
        row_number(row, "units_done"), row_number(row, "units_total"),
        row_number(row, "units_redone"), row_number(totals, "ambient_values"),
        row_number(totals, "ambient_redundant"));
    say(s, TOP_WARNING, "%s", row_text(row, "text"));
}

static void
draw_job(struct screen *s)
{
    const json_t *row = top_row(s->t, TOP_JOBS, s->t->job);

    say(s, TOP_TITLE, "job %.8s  %s  of %s", s->t->job, row_text(row, "name"),
        row_text(row, "owner"));
    say(s, TOP_WARNING, "%s", s->t->note);
    if (!row)
        say(s, TOP_PLAIN, "it is not there any more");
    else
        draw_progress(s, row);
    if (s->t->stats)
        draw_workers(s);
    put_text(s, s->lines - 1, TOP_TITLE,
             "q back  arrows scroll  c cancel  p pause");
}

void
top_draw(const struct top *t, int columns, int lines, top_put_fn *put,
         void *arg)
{
    struct screen s = { t,  columns < WIDEST ? columns : WIDEST, lines, 0, put,
                        arg };

    if (columns < 1 || lines < 1)
        return;
    if (t->job[0])
        draw_job(&s);
    else
        draw_lists(&s);
}
