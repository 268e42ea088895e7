/* lookup.c - see lookup.h */
#include "config.h"

#include "net/lookup.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

struct lookup {
    uv_async_t ready; /* tells the loop that the thread is done */
    lookup_fn *fn;    /* [loop] */
    void *arg;        /* [loop] */
    char text[ADDRESS_TEXT]; /* [fixed] */
    /* the thread's until `ready` is sent, then the loop's: */
    struct address to[LOOKUP_MOST];
    int n; /* < 0: none, for why */
    struct rad_error why;
    pthread_mutex_t mu;
    int holders;    /* [mu] the thread, and `ready` until it is closed */
    bool cancelled; /* [mu] `ready` is closed, or soon will be */
};

/* A holder has no more use of it. */
static void
drop(struct lookup *l)
{
    bool last;

    pthread_mutex_lock(&l->mu);
    last = --l->holders == 0;
    pthread_mutex_unlock(&l->mu);
    if (!last)
        return;
    pthread_mutex_destroy(&l->mu);
    free(l);
}

static void *
resolve(void *arg)
{
    struct lookup *l = arg;

    l->n = address_resolve(l->text, l->to, LOOKUP_MOST, &l->why);
    pthread_mutex_lock(&l->mu);
    if (!l->cancelled)
        uv_async_send(&l->ready);
    pthread_mutex_unlock(&l->mu);
    drop(l);
    return NULL;
}

static void
on_closed(uv_handle_t *ready)
{
    drop(ready->data);
}

void
lookup_cancel(struct lookup *l)
{
    pthread_mutex_lock(&l->mu);
    l->cancelled = true;
    pthread_mutex_unlock(&l->mu);
    uv_close((uv_handle_t *)&l->ready, on_closed);
}

static void
on_ready(uv_async_t *ready)
{
    struct lookup *l = ready->data;

    lookup_cancel(l); /* it lives until the loop's next turn */
    l->fn(l->arg, l->to, l->n, &l->why);
}

struct lookup *
lookup_start(uv_loop_t *loop, const char *text, lookup_fn *fn, void *arg)
{
    struct lookup *l = calloc(1, sizeof *l);
    pthread_t thread;

    if (!l || uv_async_init(loop, &l->ready, on_ready) < 0) {
        free(l);
        return NULL;
    }
    l->ready.data = l;
    l->fn = fn;
    l->arg = arg;
    snprintf(l->text, sizeof l->text, "%s", text);
    pthread_mutex_init(&l->mu, NULL);
    l->holders = 2;
    if (pthread_create(&thread, NULL, resolve, l) == 0) {
        pthread_detach(thread);
        return l;
    }
    lookup_cancel(l);
    drop(l); /* for the thread that did not start */
    return NULL;
}
