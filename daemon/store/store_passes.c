/* store_passes.c - what is kept of a job's passes: their records, the colours
 * and the options that they chose for pictures; and the records of another job
 * that the first pass begins with */
#include "config.h"

#include "store/store_impl.h"

#include <stdlib.h>
#include <string.h>

struct pass_task {
    struct task task;
    uint8_t id[MSG_JOB];
    uint32_t pass;
    struct saved_pass saved;
    uint8_t bytes[];
};

static int
pass_run(struct task *t)
{
    struct pass_task *p = (struct pass_task *)t;

    folder_put_pass(&store_of(t)->folder, p->id, p->pass, &p->saved);
    return 0;
}

static void
pass_done(struct task *t)
{
    struct pass_task *p = (struct pass_task *)t;

    store_of(t)->backlog -= p->saved.len;
    free(p);
}

void
store_put_pass(struct store *s, const uint8_t job[MSG_JOB], uint32_t pass,
               const struct saved_pass *saved)
{
    size_t n = saved->len;
    struct pass_task *p =
        s->journal ? store_new_task(s, sizeof *p + n, pass_run, pass_done)
                   : NULL;

    if (!p)
        return;
    memcpy(p->id, job, MSG_JOB);
    p->pass = pass;
    p->saved = *saved;
    p->saved.bytes = p->bytes;
    if (n > 0)
        memcpy(p->bytes, saved->bytes, n);
    s->backlog += n;
    task_push(&s->queue, &p->task);
}

struct colours_task {
    struct task task;
    uint8_t id[MSG_JOB];
    struct action_colours colours;
    uint8_t rgbe[];
};

static int
colours_run(struct task *t)
{
    struct colours_task *p = (struct colours_task *)t;

    folder_put_colours(&store_of(t)->folder, p->id, &p->colours);
    return 0;
}

void
store_put_colours(struct store *s, const uint8_t job[MSG_JOB],
                  const struct action_colours *colours)
{
    size_t n = 4 * (size_t)colours->columns * (size_t)colours->rows;
    struct colours_task *p =
        store_new_task(s, sizeof *p + n, colours_run, store_free_task);

    memcpy(p->id, job, MSG_JOB);
    p->colours = *colours;
    p->colours.rgbe = p->rgbe;
    memcpy(p->rgbe, colours->rgbe, n);
    task_push(&s->queue, &p->task);
}

/* Reads the records that a job begins with, another job's first pass. */
struct first_task {
    struct task task;
    uint8_t id[MSG_JOB];
    uint64_t sequence;
    struct saved_cache cache;
};

static int
first_run(struct task *t)
{
    struct first_task *k = (struct first_task *)t;

    k->cache.records =
        folder_read_first(&store_of(t)->folder, k->id, &k->cache.len, &t->err);
    return k->cache.records ? 0 : t->err.code;
}

static void
first_done(struct task *t)
{
    struct first_task *k = (struct first_task *)t;
    struct store *s = store_of(t);

    k->cache.status = status_of(t);
    k->cache.text = failure(t);
    if (is_mute(s, t))
        free(k->cache.records);
    else
        s->handler->cache(s->arg, k->id, k->sequence, &k->cache);
    free(k);
}

void
store_load_cache(struct store *s, const uint8_t job[MSG_JOB], uint64_t sequence)
{
    struct first_task *k = store_new_task(s, sizeof *k, first_run, first_done);

    memcpy(k->id, job, MSG_JOB);
    k->sequence = sequence;
    task_push(&s->queue, &k->task);
}

struct options_task {
    struct task task;
    uint8_t id[MSG_JOB];
    char options[];
};

static int
options_run(struct task *t)
{
    struct options_task *o = (struct options_task *)t;

    return folder_set_options(&store_of(t)->folder, o->id, o->options, &t->err);
}

void
store_set_options(struct store *s, const uint8_t job[MSG_JOB],
                  const char *options)
{
    size_t n = strlen(options) + 1;
    struct options_task *o =
        store_new_task(s, sizeof *o + n, options_run, store_free_task);

    memcpy(o->id, job, MSG_JOB);
    memcpy(o->options, options, n);
    task_push(&s->queue, &o->task);
}
