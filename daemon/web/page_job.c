/* page_job.c - the page of a job; see page.h */
#include "config.h"

#include "web/page.h"

#include "base/list.h"
#include "web/chart.h"

#include <string.h>

/* --- facts and progress --- */

static void
begin_fact(struct markup *m, const char *what)
{
    markup_print(m, "<div><dt>%s</dt><dd>", what);
}

static void
end_fact(struct markup *m)
{
    markup_raw(m, "</dd></div>");
}

static void
put_number(struct markup *m, const char *what, double v)
{
    begin_fact(m, what);
    markup_print(m, "%.0f", v);
    end_fact(m);
}

static void
put_time(struct markup *m, const char *what, double s)
{
    begin_fact(m, what);
    markup_span(m, s);
    end_fact(m);
}

/* The relative error, as the coordinator estimates it from the rows so far. */
static void
put_error(struct markup *m, const struct watch *w)
{
    const json_t *of = json_object_get(w->units.head, "error");
    double error = markup_number(w->detail, "estimated_error");
    double goal = markup_number(w->detail, "goal_error");
    double left_out = markup_number(of, "left_out");

    if (!(error > 0))
        error = markup_number(of, "estimate");
    if (!(error > 0))
        return;
    begin_fact(m, markup_number(w->detail, "done") < 1 ? "Error so far, about"
                                                       : "Error, about");
    markup_print(m, "%.2g %%", 100 * error);
    if (goal > 0)
        markup_print(m, " <span class=\"dim\">of %.2g %%</span>", 100 * goal);
    if (left_out >= MSG_LEFT_OUT_TOLD)
        markup_print(m,
                     " <span class=\"dim\">and %.2g %% of the light "
                     "left out by -ab</span>",
                     100 * left_out);
    end_fact(m);
}

static void
put_progress(struct markup *m, const json_t *job)
{
    double left = markup_number(job, "left_s"),
           frames = markup_number(job, "frames");

    put_time(m, "Time", markup_number(job, "elapsed_s"));
    if (left > 0)
        put_time(m, "Left, about", left);
    if (markup_number(job, "passes") > 0) {
        begin_fact(m, "Pass");
        markup_print(m, "%.0f of %.0f", markup_number(job, "pass"),
                     markup_number(job, "passes"));
        end_fact(m);
    }
    begin_fact(m, "Units");
    markup_print(m, "%.0f of %.0f", markup_number(job, "units_done"),
                 markup_number(job, "units_total"));
    end_fact(m);
    if (frames > 1) {
        begin_fact(m, "Frames");
        markup_print(m, "%.0f of %.0f", markup_number(job, "frames_ready"),
                     frames);
        end_fact(m);
    }
}

static void
put_head(struct markup *m, const struct watch *w)
{
    const json_t *job = w->detail;

    markup_raw(m, "<section id=\"job\"><h1>");
    markup_text(m, markup_member(job, "name"));
    markup_raw(m, "</h1><p>");
    page_state(m, markup_member(job, "state"));
    markup_raw(m, " of <b>");
    markup_text(m, markup_member(job, "owner"));
    markup_print(m, "</b> <span class=\"id dim\">%s</span></p>", w->hex);
    if (markup_member(job, "text")[0]) {
        markup_raw(m, "<p class=\"note\">");
        markup_text(m, markup_member(job, "text"));
        markup_raw(m, "</p>");
    }
    markup_raw(m, "<p class=\"done large\">");
    page_done(m, job);
    markup_raw(m, "</p><dl>");
    put_progress(m, job);
    begin_fact(m, "Rays");
    markup_count(m, markup_number(job, "rays"));
    end_fact(m);
    put_error(m, w);
    put_number(m, "Workers", markup_number(job, "workers"));
    put_number(m, "Priority", markup_number(job, "priority"));
    begin_fact(m, "Picture");
    markup_print(m, "%.0f &times; %.0f", markup_number(job, "width"),
                 markup_number(job, "height"));
    end_fact(m);
    markup_raw(m, "</dl></section>\n");
}

/* --- the picture --- */

enum { FRAME_STEPS = 10 }; /* of the links through an animation */

static void
put_frame(struct markup *m, const struct watch *w, unsigned frame,
          const char *before, const char *behind)
{
    if (frame == w->frame)
        markup_raw(m, " <b>");
    else
        markup_print(m, " <a href=\"%s?frame=%u\">", w->hex, frame);
    markup_print(m, "%s%u%s", before, frame + 1, behind);
    markup_raw(m, frame == w->frame ? "</b>" : "</a>");
}

/* Links to the frames beside the one that is shown, and through all of them. */
static void
put_frames(struct markup *m, const struct watch *w)
{
    double n = markup_number(w->detail, "frames");

    if (n <= 1)
        return;
    markup_raw(m, "<nav aria-label=\"Frames\"><p>");
    if (w->frame > 0)
        put_frame(m, w, w->frame - 1, "&larr; frame ", "");
    markup_print(m, " <b>frame %u of %.0f</b>", w->frame + 1, n);
    if (w->frame + 1 < n)
        put_frame(m, w, w->frame + 1, "frame ", " &rarr;");
    markup_raw(m, "</p>");
    if (n > FRAME_STEPS) {
        markup_raw(m, "<p>");
        for (int i = 0; i <= FRAME_STEPS; i++)
            put_frame(m, w, (unsigned)(i * (n - 1) / FRAME_STEPS), "", "");
        markup_raw(m, "</p>");
    }
    markup_raw(m, "</nav>");
}

static void
put_picture(struct markup *m, const struct watch *w)
{
    markup_print(m,
                 "<section id=\"picture\" data-version=\"%llu\" "
                 "data-raw=\"%s/picture.rgbe?frame=%u\"><h2>Picture</h2>",
                 (unsigned long long)w->picture_version, w->hex, w->frame);
    put_frames(m, w);
    if (w->png) {
        markup_print(m,
                     "<figure><img id=\"shown\" src=\"%s/picture.png"
                     "?frame=%u&amp;v=%llu\" width=\"%d\" height=\"%d\" alt=\""
                     "The picture as far as it is rendered\"></figure>",
                     w->hex, w->frame, (unsigned long long)w->picture_version,
                     w->width, w->height);
        if (w->factor > 1)
            markup_print(m,
                         "<p class=\"dim\">Each pixel shown is the mean of %d "
                         "by %d.</p>",
                         w->factor, w->factor);
    } else {
        markup_raw(m, "<p class=\"empty\">No picture yet");
        markup_raw(m, w->note[0] ? ": " : "");
        markup_text(m, w->note);
        markup_raw(m, ".</p>");
    }
    markup_raw(m, "</section>\n");
}

/* --- units and workers --- */

static const struct page_column columns[] = {
    { "Worker", false },   { "Threads", true },      { "Units", true },
    { "Rays", true },      { "Busy", true },         { "Bytes in", true },
    { "Bytes out", true }, { "Memory, most", true },
};

static void
put_worker(struct markup *m, const json_t *w)
{
    double busy = markup_number(w, "busy_s"), idle = markup_number(w, "idle_s");
    double wait = markup_number(w, "wait_base_line_s");
    double all = busy + idle + wait;

    page_row(m, markup_member(w, "name"));
    markup_raw(m, "<th scope=\"row\" class=\"name\">");
    markup_text(m, markup_member(w, "name"));
    markup_print(m,
                 "</th><td class=\"num\">%.0f</td><td class=\"num\">%.0f"
                 "</td><td class=\"num\">",
                 markup_number(w, "threads"), markup_number(w, "units"));
    markup_count(m, markup_number(w, "rays") +
                        markup_number(w, "rays_under_way"));
    markup_raw(m, "</td><td class=\"num\">");
    if (all > 0)
        markup_print(m, "%.0f %%", 100 * busy / all);
    markup_raw(m, "</td><td class=\"num\">");
    markup_size(m, markup_number(w, "bytes_in"));
    markup_raw(m, "</td><td class=\"num\">");
    markup_size(m, markup_number(w, "bytes_out"));
    markup_raw(m, "</td><td class=\"num\">");
    markup_size(m, markup_number(w, "peak_rss_bytes"));
    markup_raw(m, "</td></tr>\n");
}

static void
put_units(struct markup *m, const struct watch *w)
{
    const json_t *rows = json_object_get(w->units.head, "workers"), *row;
    size_t i;

    markup_raw(m, "<section id=\"units\"><h2>Units by worker</h2>");
    if (w->units.head)
        chart_units(m, &w->units);
    else
        markup_raw(m, "<p class=\"empty\">No statistics yet.</p>");
    if (json_array_size(rows) > 0) {
        page_table_begin(m, "Workers of this job", columns, N_ELEM(columns));
        json_array_foreach(rows, i, row) put_worker(m, row);
        page_table_end(m);
    }
    markup_raw(m, "</section>\n");
}

/* --- statistics --- */

static const struct {
    const char *key, *what;
} totals[] = {
    { "primary_rays", "Primary rays" },
    { "shadow_rays", "Shadow rays" },
    { "ambient_rays", "Ambient rays" },
    { "intersection_tests", "Intersection tests" },
    { "speculative_rays", "Speculative rays" },
    { "dropped_rays", "Dropped rays" },
    { "ambient_values", "Ambient values" },
    { "reused_values", "Values reused" },
    { "ambient_redundant", "Values redundant" },
    { "nan_pixels", "Pixels that are no number" },
    { "units_redone", "Units done again" },
};

static void
put_statistics(struct markup *m, const struct watch *w)
{
    const json_t *all = json_object_get(w->units.head, "totals");
    const json_t *time = json_object_get(w->units.head, "time");
    const json_t *scene = json_object_get(w->units.head, "scene");

    markup_raw(m, "<section id=\"statistics\"><h2>Statistics</h2>");
    if (!w->units.head) {
        markup_raw(m, "<p class=\"empty\">No statistics yet.</p></section>\n");
        return;
    }
    markup_raw(m, "<dl>");
    for (size_t i = 0; i < sizeof totals / sizeof totals[0]; i++) {
        begin_fact(m, totals[i].what);
        markup_count(m, markup_number(all, totals[i].key));
        end_fact(m);
    }
    put_time(m, "To compile", markup_number(time, "compile_s"));
    put_time(m, "To send", markup_number(time, "transfer_s"));
    put_time(m, "To load", markup_number(time, "load_s"));
    put_time(m, "To render", markup_number(time, "render_s"));
    begin_fact(m, "Objects");
    markup_count(m, markup_number(scene, "objects"));
    end_fact(m);
    begin_fact(m, "Partition");
    markup_text(m, markup_member(w->units.head, "partition"));
    end_fact(m);
    markup_raw(m, "</dl></section>\n");
}

/* --- the command that makes the picture again --- */

/* Add words of the job to a command line, quoted so that a shell takes each for
 * a plain word.  files: the words are names of files, so "./" goes ahead of a
 * word that radsubmit would take for an option, a command or a variable. */
static void
put_words(struct markup *to, const char *s, bool files)
{
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstu"
        "vwxyz0123456789._/+=,:@%-";
    static const char blanks[] = " \t\n";

    for (s += strspn(s, blanks); *s; s += strspn(s, blanks)) {
        size_t n = strcspn(s, blanks);

        markup_raw(to, files && strchr("-!@$", *s) ? " ./" : " ");
        if (strspn(s, plain) >= n) {
            markup_bytes(to, s, n);
            s += n;
            continue;
        }
        markup_raw(to, "'");
        for (; n > 0; n--, s++)
            markup_bytes(to, *s == '\'' ? "'\\''" : s, *s == '\'' ? 4 : 1);
        markup_raw(to, "'");
    }
}

/* Does the text consist of view options and numbers alone?  The text comes from
 * the picture's header, into which a user can write anything. */
static bool
is_view(const char *s)
{
    static const char blanks[] = " \t\n";

    for (s += strspn(s, blanks); *s; s += strspn(s, blanks)) {
        size_t n = strcspn(s, blanks);

        if (strspn(s, "0123456789.eE+-") < n &&
            (strncmp(s, "-v", 2) != 0 || n > 4 || strcspn(s + 1, "-=") < n - 1))
            return false;
        s += n;
    }
    return true;
}

static void
put_command(struct markup *m, const struct watch *w)
{
    const char *partition = markup_member(w->units.head, "partition");
    struct markup words = { 0 };

    markup_raw(m, "<section id=\"command\"><h2>Command line</h2>");
    if (!w->units.head || !w->view[0]) {
        markup_raw(m, "<p class=\"empty\">Known with the first picture.</p>"
                      "</section>\n");
        return;
    }
    markup_raw(&words, "radsubmit");
    if (is_view(w->view))
        put_words(&words, w->view, false);
    put_words(&words, markup_member(w->units.head, "options"), false);
    if (partition[0] && strcmp(partition, "auto") != 0) {
        markup_raw(&words, " --partition");
        put_words(&words, partition, false);
    }
    markup_raw(&words, " -o picture.hdr");
    put_words(&words, w->scene[0] ? w->scene : "scene.rad", true);
    m->failed |= words.failed;
    markup_raw(m, "<pre id=\"words\">");
    markup_text(m, words.text);
    markup_raw(m, "</pre></section>\n");
    markup_release(&words);
}

void
page_job(struct markup *m, const struct model *c, const struct watch *w)
{
    page_trouble(m, c, w);
    if (w->gone[0])
        return;
    put_head(m, w);
    put_picture(m, w);
    put_units(m, w);
    put_statistics(m, w);
    put_command(m, w);
}
