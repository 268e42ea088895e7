/* top.h - what radctl top shows, apart from the terminal
 *
 * A model of the cluster as the coordinator last told it, and of what the user
 * looks at; keys change it, and it is drawn as lines of text.  No clock, no
 * terminal and no connection: those are ctl_top.c's.
 * Two screens: lists of workers and of jobs, one of which the keys are for, and
 * one job with its units by worker.
 * Thread: one.  */
#ifndef RADD_CLIENT_TOP_H
#define RADD_CLIENT_TOP_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

enum top_pane { TOP_WORKERS, TOP_JOBS, TOP_NPANE };

/* Keys that are no characters. */
enum {
    TOP_KEY_UP = 1000,
    TOP_KEY_DOWN,
    TOP_KEY_PAGE_UP,
    TOP_KEY_PAGE_DOWN,
    TOP_KEY_ENTER,
    TOP_KEY_BACK, /* Escape */
    TOP_KEY_ERASE
};

/* What a key asks of the caller; all but the first three name top.about. */
enum top_wish {
    TOP_NOTHING,
    TOP_QUIT,
    TOP_LOOK, /* get data at once */
    TOP_CANCEL,
    TOP_PAUSE,
    TOP_RESUME,
    TOP_DRAIN,
    TOP_UNDRAIN
};

struct top_list {
    json_t *rows;    /* array of objects; NULL: none came yet */
    json_t *rates;   /* [rays/s] by the row's name */
    int sort;        /* column, -1: as the coordinator has them */
    bool back;       /* from the largest down, or from the smallest up */
    char chosen[80]; /* name of a row; one that is not there: the first */
};

enum { TOP_FILTER = 40, TOP_NOTE = 160 };

struct top {
    struct top_list list[TOP_NPANE];
    json_t *status, *stats; /* stats: of the job that is looked into, or NULL */
    double at_s;            /* when the rows came; 0: never */
    enum top_pane pane;
    bool closed;         /* jobs that are over are listed, too */
    char job[80];        /* that is looked into; "": the lists are shown */
    int scroll;          /* of its workers */
    enum top_wish asked; /* the question that is open */
    char about[80];      /* and the job or worker that it is about */
    bool editing;        /* the filter */
    char filter[TOP_FILTER];
    char note[TOP_NOTE]; /* of the last wish, or why nothing comes */
    bool lost;           /* the coordinator */
};

void top_init(struct top *t);
void top_release(struct top *t);

/* What came at that time [s, any origin]; takes the references.  stats: of the
 * job that is looked into (radd.stats(5)), or NULL. */
void top_take(struct top *t, double now_s, json_t *status, json_t *workers,
              json_t *jobs, json_t *stats);

/* A key: a character, or one of those above. */
enum top_wish top_key(struct top *t, int key);

/* The name of the row that is chosen in a list; "": there is none. */
const char *top_chosen(const struct top *t, enum top_pane pane);

/* Rows that the filter leaves, in their order: *n of them, borrowed; to be
 * freed.  NULL when memory is out. */
const json_t **top_rows(const struct top *t, enum top_pane pane, size_t *n);

/* Compare two rows by a column of top_lines.c. */
int top_compare(const struct top *t, enum top_pane pane, int column,
                const json_t *a, const json_t *b);
int top_ncolumns(enum top_pane pane);

enum top_look { TOP_PLAIN, TOP_TITLE, TOP_HEAD, TOP_CHOSEN, TOP_WARNING };

/* A line of the screen, at most as many columns wide as the screen, clean. */
typedef void top_put_fn(void *arg, int line, enum top_look look,
                        const char *text);

/* Draw all lines of a screen that are not empty, from 0. */
void top_draw(const struct top *t, int columns, int lines, top_put_fn *put,
              void *arg);

#endif
