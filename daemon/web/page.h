/* page.h - the pages: the cluster, one job, an error
 *
 * Whole pages work by themselves; the same sections, by their ids, are sent
 * again as events while a page is open (page.js puts them in place).
 * Thread: the loop's. */
#ifndef RADD_WEB_PAGE_H
#define RADD_WEB_PAGE_H

#include "draw/markup.h"
#include "observer/model.h"
#include "observer/watch.h"

#define PAGE_JOBS    200 /* rows that are shown; others are counted */
#define PAGE_WORKERS 300

/* Ahead of the sections and behind them.  events: where what changes comes
 * from; NULL: the page stays as it is. */
void page_begin(struct markup *m, const char *title, const char *events);
void page_end(struct markup *m);

/* The sections of the cluster, and of a job, which is known. */
void page_home(struct markup *m, const struct model *c);
void page_job(struct markup *m, const struct model *c, const struct watch *w);

/* A whole page that says why there is none. */
void page_error(struct markup *m, unsigned status, const char *text);

/* Said on each page while the coordinator is away. */
void page_trouble(struct markup *m, const struct model *c);
/* The state of a job or of a worker, marked by colour. */
void page_state(struct markup *m, const char *state);
/* How far a job is. */
void page_done(struct markup *m, const json_t *job);
/* Seconds that a job will take yet, by what it took so far; below 0: nobody
 * knows. */
double page_left(const json_t *job);

#endif
