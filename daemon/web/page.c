/* page.c - parts that all pages have; see page.h */
#include "config.h"

#include "web/page.h"

#include <string.h>

enum { MOST_UP = 3 }; /* folders from the deepest of our paths to the root */

/* Write an address below radweb's root, as seen from a path, as the value of an
 * attribute.  From a deeper path, at which there is nothing but an error, the
 * address leads nowhere. */
static void
put_address(struct markup *m, const char *attribute, const char *path,
            const char *below)
{
    const char *slash = strchr(path, '/');

    markup_print(m, " %s=\"./", attribute);
    for (int i = 0; i < MOST_UP && slash; i++)
        if ((slash = strchr(slash + 1, '/')))
            markup_raw(m, "../");
    markup_print(m, "%s\"", below);
}

void
page_begin(struct markup *m, const char *path, const char *title,
           const char *events)
{
    markup_raw(m, "<!doctype html>\n<html lang=\"en\"><head>"
                  "<meta charset=\"utf-8\">"
                  "<meta name=\"viewport\" content=\"width=device-width, "
                  "initial-scale=1\">"
                  "<meta name=\"color-scheme\" content=\"light dark\"><title>");
    markup_text(m, title);
    markup_raw(m, "</title><link rel=\"icon\"");
    put_address(m, "href", path, "icon.svg");
    markup_raw(m, "><link rel=\"stylesheet\"");
    put_address(m, "href", path, "style.css");
    markup_raw(m, "><script defer");
    put_address(m, "src", path, "page.js");
    markup_raw(m, "></script>");
    if (events)
        markup_raw(m, "<noscript><meta http-equiv=\"refresh\" content=\"10\">"
                      "</noscript>");
    markup_raw(m, "</head>\n<body");
    if (events) {
        markup_raw(m, " data-events=\"");
        markup_text(m, events);
        markup_raw(m, "\"");
    }
    markup_raw(m, "><header><a class=\"home\"");
    put_address(m, "href", path, "");
    markup_raw(m, ">radd</a><span id=\"live\" "
                  "role=\"status\"></span></header>\n<main>\n");
}

void
page_end(struct markup *m, const char *path)
{
    markup_raw(m, "</main>\n<footer>radweb " PACKAGE_VERSION " &middot; <a");
    put_address(m, "href", path, "metrics");
    markup_raw(m, ">metrics</a> &middot; <a");
    put_address(m, "href", path, "api/v1/jobs.json");
    markup_raw(m, ">jobs.json</a> &middot; <a");
    put_address(m, "href", path, "api/v1/workers.json");
    markup_raw(m, ">workers.json</a></footer></body></html>\n");
}

void
page_error(struct markup *m, const char *path, unsigned status,
           const char *text)
{
    page_begin(m, path, "radd", NULL);
    markup_print(m, "<section id=\"error\"><h1>%u</h1><p>", status);
    markup_text(m, text);
    markup_raw(m, ".</p></section>");
    page_end(m, path);
}

void
page_trouble(struct markup *m, const struct model *c, const struct watch *w)
{
    /* what is told once is an alert; the age, which changes, is none */
    markup_print(m, "<section id=\"trouble\" class=\"%s%s\">",
                 c->up ? "" : "away", w && w->gone[0] ? " gone" : "");
    if (!c->up) {
        markup_raw(m,
                   "<p class=\"trouble\"><span role=\"alert\">The coordinator "
                   "cannot be asked: ");
        markup_text(m, session_why(c->session));
        markup_raw(m, ".</span>");
        if (c->asked_ms) {
            markup_raw(m, " What is shown is ");
            markup_span(m, (double)(uv_now(c->loop) - c->asked_ms) / 1000);
            markup_raw(m, " old.");
        }
        markup_raw(m, "</p>");
    }
    if (w && w->gone[0]) {
        markup_raw(m, "<p class=\"trouble\" role=\"alert\">This job is gone: ");
        markup_text(m, w->gone);
        markup_raw(m, ".</p>");
    }
    if (json_is_true(json_object_get(c->status, "disk_full")))
        markup_raw(m, "<p class=\"trouble\" role=\"alert\">The "
                      "coordinator&#39;s disk is full: jobs are held.</p>");
    markup_raw(m, "</section>\n");
}

/* The style class of a state: its colour. */
static const char *
class_of(const char *state)
{
    static const char *const classes[][2] = {
        { "running", "run" }, { "working", "run" },   { "done", "good" },
        { "failed", "bad" },  { "gone", "bad" },      { "held", "warn" },
        { "paused", "warn" }, { "draining", "warn" }, { "no room", "warn" },
    };

    for (size_t i = 0; i < sizeof classes / sizeof classes[0]; i++)
        if (strcmp(state, classes[i][0]) == 0)
            return classes[i][1];
    return "calm";
}

void
page_state(struct markup *m, const char *state)
{
    markup_print(m, "<span class=\"state %s\">", class_of(state));
    markup_text(m, state);
    markup_raw(m, "</span>");
}

void
page_table_begin(struct markup *m, const char *label,
                 const struct page_column *columns, int n)
{
    /* with a place in the order of Tab, so that keys can scroll it */
    markup_print(m,
                 "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
                 "aria-label=\"%s\"><table aria-label=\"%s\"><thead><tr>",
                 label, label);
    for (int i = 0; i < n; i++)
        markup_print(m, "<th scope=\"col\"%s>%s</th>",
                     columns[i].number ? " class=\"num\"" : "",
                     columns[i].title);
    markup_raw(m, "</tr></thead><tbody>\n");
}

void
page_table_end(struct markup *m)
{
    markup_raw(m, "</tbody></table></div>");
}

void
page_row(struct markup *m, const char *key)
{
    markup_raw(m, "<tr data-key=\"");
    markup_text(m, key);
    markup_raw(m, "\">");
}

void
page_done(struct markup *m, const json_t *job)
{
    double done = markup_number(job, "done");

    done = done < 0 ? 0 : done > 1 ? 1 : done;
    /* rounded down, so 100 % means done */
    markup_print(m,
                 "<progress value=\"%.4f\" aria-hidden=\"true\"></progress> "
                 "<b>%d %%</b>",
                 done, (int)(done * 100));
}
