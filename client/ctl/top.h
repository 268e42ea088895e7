/* top.h - the state of radctl top, apart from the terminal
 *
 * It has the cluster's data as they came last, and what the user looks at.
 * Keys change it, and it is drawn as lines of text.  ctl_top.c has the clock,
 * the terminal and the connection.
 * There are two screens: the lists of workers and jobs, one of which keys act
 * on; and one job with its units by worker.
 * Thread: one. */
#ifndef RADD_CLIENT_TOP_H
#define RADD_CLIENT_TOP_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

enum top_pane { TOP_WORKERS, TOP_JOBS, TOP_NPANE };

/* Keys that are not characters. */
enum {
    TOP_KEY_UP = 1000,
    TOP_KEY_DOWN,
    TOP_KEY_PAGE_UP,
    TOP_KEY_PAGE_DOWN,
    TOP_KEY_ENTER,
    TOP_KEY_BACK, /* Escape */
    TOP_KEY_ERASE
};

/* What a key asks of the caller.  All but the first three are about top.about.
 */
enum top_wish {
    TOP_NOTHING,
    TOP_QUIT,
    TOP_LOOK, /* get new data at once */
    TOP_CANCEL,
    TOP_PAUSE,
    TOP_RESUME,
    TOP_DRAIN,
    TOP_UNDRAIN
};

struct top_list {
    json_t *rows;    /* array of objects; NULL: none has come */
    json_t *rates;   /* rays a second, by the row's name */
    int sort;        /* column; -1: the coordinator's order */
    bool back;       /* reverse the order, which begins with the largest */
    char chosen[80]; /* name of the chosen row; not in the list: the first */
};

enum { TOP_FILTER = 40, TOP_NOTE = 160 };

struct top {
    struct top_list list[TOP_NPANE];
    json_t *status, *stats; /* stats: of `job`; or NULL */
    double at_s;            /* time of the rows [s]; 0: none have come */
    enum top_pane pane;
    bool closed;         /* list jobs that are over, too */
    char job[80];        /* the job that is shown; "": the lists are */
    int scroll;          /* first of its workers that is shown */
    enum top_wish asked; /* the wish that the user has to confirm */
    char about[80];      /* the job or worker that it is about */
    bool editing;        /* keys change the filter */
    char filter[TOP_FILTER];
    char note[TOP_NOTE]; /* result of the last wish, or why no data come */
    bool lost;           /* the coordinator cannot be reached */
};

void top_init(struct top *t);
void top_release(struct top *t);

/* Take new data, which came at now_s [s, any origin]; takes the references.  Of
 * two rows of a job the later counts.  stats: of `job` (radd.stats(5)), or
 * NULL. */
void top_take(struct top *t, double now_s, json_t *status, json_t *workers,
              json_t *jobs, json_t *stats);

/* Handle a key: a character, or one of those above. */
enum top_wish top_key(struct top *t, int key);

enum top_look { TOP_PLAIN, TOP_TITLE, TOP_HEAD, TOP_CHOSEN, TOP_WARNING };

/* Puts a line of the screen; text has no control characters and fits the width.
 */
typedef void top_put_fn(void *arg, int line, enum top_look look,
                        const char *text);

/* Draw all lines of a screen that are not empty; lines count from 0. */
void top_draw(const struct top *t, int columns, int lines, top_put_fn *put,
              void *arg);

#endif
