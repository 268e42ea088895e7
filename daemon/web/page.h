/* page.h - the pages: of the cluster, of a job, of an error
 *
 * A page is complete without script.  While it is open the same sections come
 * as events, and page.js puts them in place by their ids.
 * Thread: the loop's. */
#ifndef RADD_WEB_PAGE_H
#define RADD_WEB_PAGE_H

#include "observer/markup.h"
#include "observer/model.h"
#include "observer/watch.h"

#define PAGE_JOBS    200 /* most rows shown; a line counts the others */
#define PAGE_WORKERS 300

/* Write a page's text before its sections, and behind them.  path: of the page,
 * from which all addresses in it are relative, so that a proxy may have radweb
 * below a path of its own.  events: relative address of the page's event
 * stream; NULL: the page does not change. */
void page_begin(struct markup *m, const char *path, const char *title,
                const char *events);
void page_end(struct markup *m, const char *path);

/* Write the sections of the cluster's page; of a job's page.  Of a job that is
 * gone this is a warning alone, for a page that shows the job to keep. */
void page_home(struct markup *m, const struct model *c);
void page_job(struct markup *m, const struct model *c, const struct watch *w);

/* Write a whole page, for a path, with an HTTP status and the reason. */
void page_error(struct markup *m, const char *path, unsigned status,
                const char *text);

/* Write what is wrong: the coordinator is away, its disk is full, the page's
 * job (w; NULL: the page has none) is gone. */
void page_trouble(struct markup *m, const struct model *c,
                  const struct watch *w);
/* Write the state of a job or of a worker, with its colour. */
void page_state(struct markup *m, const char *state);
/* Begin and end a table, which scrolls sideways where it is wider than the
 * page. label: its name, for those who hear the page. */
struct page_column {
    const char *title;
    bool number;
};
void page_table_begin(struct markup *m, const char *label,
                      const struct page_column *columns, int n);
void page_table_end(struct markup *m);
/* Begin a table's row; page.js knows it by its key, wherever it moves. */
void page_row(struct markup *m, const char *key);
/* Write a job's progress, as a bar and in per cent. */
void page_done(struct markup *m, const json_t *job);

#endif
