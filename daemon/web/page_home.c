/* page_home.c - the page of the cluster; see page.h */
#include "config.h"

#include "web/page.h"

#include "base/list.h"
#include "web/chart.h"

#include <stdio.h>
#include <string.h>

/* --- the cluster in a row of figures --- */

static void
begin_tile(struct markup *m, const char *what)
{
    markup_print(m, "<div class=\"tile\"><span class=\"dim\">%s</span><b>",
                 what);
}

static unsigned
count_state(const json_t *rows, const char *state)
{
    const json_t *row;
    unsigned n = 0;
    size_t i;

    json_array_foreach(rows, i, row) n +=
        strcmp(markup_member(row, "state"), state) == 0;
    return n;
}

static void
put_summary(struct markup *m, const struct model *c)
{
    markup_raw(m, "<section id=\"summary\"><h1>Cluster</h1>"
                  "<div class=\"tiles\">");
    begin_tile(m, "Workers");
    markup_print(m, "%.0f</b><span class=\"dim\">%.0f threads</span></div>",
                 markup_number(c->status, "workers"),
                 markup_number(c->status, "threads"));
    begin_tile(m, "Jobs");
    markup_print(m,
                 "%.0f</b><span class=\"dim\">%u running, %u waiting"
                 "</span></div>",
                 markup_number(c->status, "jobs"),
                 count_state(c->open, "running"),
                 count_state(c->open, "waiting"));
    begin_tile(m, "Rays a second");
    markup_count(m, c->rays_s);
    markup_raw(m, "</b><span class=\"dim\">of all jobs</span></div>");
    begin_tile(m, "Threads at work");
    markup_print(m,
                 "%.0f %%</b><span class=\"dim\">of those that are there"
                 "</span></div></div></section>\n",
                 100 * c->at_work);
}

/* --- jobs --- */

static const struct page_column job_columns[] = {
    { "Job", false },   { "Name", false },    { "State", false },
    { "Done", false },  { "Left", true },     { "Time", true },
    { "Owner", false }, { "Priority", true }, { "Workers", true },
    { "Note", false },
};

static void
put_job(struct markup *m, const json_t *job)
{
    const char *name = markup_member(job, "name");
    double left = markup_number(job, "left_s");
    char brief[9];

    snprintf(brief, sizeof brief, "%s", markup_member(job, "job"));
    page_row(m, markup_member(job, "job"));
    markup_raw(m, "<td class=\"id\">");
    markup_text(m, brief);
    markup_raw(m, "</td><th scope=\"row\" class=\"name\"><a href=\"jobs/");
    markup_text(m, markup_member(job, "job"));
    markup_raw(m, "\">");
    markup_text(m, name[0] ? name : brief);
    markup_raw(m, "</a></th><td>");
    page_state(m, markup_member(job, "state"));
    markup_raw(m, "</td><td class=\"done\">");
    page_done(m, job);
    markup_raw(m, "</td><td class=\"num\">");
    if (left > 0)
        markup_span(m, left);
    markup_raw(m, "</td><td class=\"num\">");
    markup_span(m, markup_number(job, "elapsed_s"));
    markup_raw(m, "</td><td>");
    markup_text(m, markup_member(job, "owner"));
    markup_print(m,
                 "</td><td class=\"num\">%.0f</td><td class=\"num\">%.0f"
                 "</td><td class=\"note\">",
                 markup_number(job, "priority"), markup_number(job, "workers"));
    markup_text(m, markup_member(job, "text"));
    markup_raw(m, "</td></tr>\n");
}

static size_t
put_jobs_of(struct markup *m, const json_t *rows, size_t n)
{
    const json_t *row;
    size_t i;

    json_array_foreach(rows, i, row)
    {
        if (n == PAGE_JOBS)
            break;
        put_job(m, row);
        n++;
    }
    return n;
}

static void
put_jobs(struct markup *m, const struct model *c)
{
    size_t n, all = json_array_size(c->open) + json_array_size(c->over);
    double kept = markup_number(c->status, "jobs_kept");

    markup_raw(m, "<section id=\"jobs\"><h2>Jobs</h2>");
    if (all == 0) {
        markup_raw(m, "<p class=\"empty\">No jobs yet. A job is submitted by "
                      "<code>radsubmit</code>.</p></section>\n");
        return;
    }
    page_table_begin(m, "Jobs", job_columns, N_ELEM(job_columns));
    n = put_jobs_of(m, c->open, 0);
    n = put_jobs_of(m, c->over, n);
    page_table_end(m);
    if (kept > (double)n)
        markup_print(m, "<p class=\"dim\">%zu of %.0f jobs are shown.</p>", n,
                     kept);
    markup_raw(m, "</section>\n");
}

/* --- workers --- */

static const struct page_column worker_columns[] = {
    { "Worker", false }, { "State", false },   { "Load", true },
    { "Threads", true }, { "Units", true },    { "Memory", true },
    { "For", true },     { "Address", false }, { "Program", false },
    { "Note", false },
};

static void
put_worker(struct markup *m, const json_t *w)
{
    page_row(m, markup_member(w, "name"));
    markup_raw(m, "<th scope=\"row\" class=\"name\">");
    markup_text(m, markup_member(w, "name"));
    markup_raw(m, "</th><td>");
    page_state(m, markup_member(w, "state"));
    markup_print(m,
                 "</td><td class=\"num\">%.1f</td><td class=\"num\">%.0f"
                 "</td><td class=\"num\">%.0f</td><td class=\"num\">",
                 markup_number(w, "load"), markup_number(w, "threads"),
                 markup_number(w, "units"));
    markup_size(m, markup_number(w, "memory"));
    markup_raw(m, "</td><td class=\"num\">");
    markup_span(m, markup_number(w, "since_s"));
    markup_raw(m, "</td><td>");
    markup_text(m, markup_member(w, "address"));
    markup_raw(m, "</td><td>");
    markup_text(m, markup_member(w, "program"));
    markup_raw(m, "</td><td class=\"note\">");
    markup_text(m, markup_member(w, "text"));
    markup_raw(m, "</td></tr>\n");
}

static void
put_workers(struct markup *m, const struct model *c)
{
    const json_t *row;
    size_t i;

    markup_raw(m, "<section id=\"workers\"><h2>Workers</h2>");
    if (json_array_size(c->workers) == 0) {
        markup_raw(m, "<p class=\"empty\">No worker has come yet. "
                      "<code>radd</code> is what a workstation runs.</p>"
                      "</section>\n");
        return;
    }
    page_table_begin(m, "Workers", worker_columns, N_ELEM(worker_columns));
    json_array_foreach(c->workers, i, row)
    {
        if (i == PAGE_WORKERS)
            break;
        put_worker(m, row);
    }
    page_table_end(m);
    if (json_array_size(c->workers) > PAGE_WORKERS)
        markup_print(m, "<p class=\"dim\">%d of %zu workers are shown.</p>",
                     PAGE_WORKERS, json_array_size(c->workers));
    markup_raw(m, "</section>\n");
}

void
page_home(struct markup *m, const struct model *c)
{
    page_trouble(m, c, NULL);
    put_summary(m, c);
    put_jobs(m, c);
    markup_raw(m, "<section id=\"history\"><h2>Last hour</h2>");
    chart_history(m, &c->history);
    markup_raw(m, "</section>\n");
    put_workers(m, c);
}
