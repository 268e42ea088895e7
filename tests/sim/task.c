/* task.c - see task.h */
#include "config.h"

#include "task.h"

#include "base/list.h"
#include "fibre.h"

#include <stdio.h>
#include <stdlib.h>

_Noreturn static void
out_of_memory(void)
{
    fputs("sim: out of memory\n", stderr);
    abort();
}

static void
work(void *arg)
{
    struct task *t = arg;

    team_work(t->team, NULL);
    t->over = --t->members == 0;
}

/* As many members as the real pool's teams have at most. */
static int
most_members(const struct team_spec *spec, int nthreads)
{
    int nlines = spec->last - spec->first;

    if (nthreads == 0)
        return 1;
    return nthreads < nlines ? nthreads : nlines;
}

/* The rows of a pass's unit. */
static struct msg_unit
unit_of_pass(const struct rad_quincunx *q, const struct strict_pass *p)
{
    int y = team_line_row(q, p->least - 1);

    return (struct msg_unit){
        .unit = p->unit,
        .attempt = p->attempt,
        .frame = p->frame,
        .y = (uint32_t)y,
        .width = (uint32_t)q->width,
        .height = (uint32_t)(rad_quincunx_base_row(q, p->spec.last - 1) + 1 - y)
    };
}

static void
describe_window(const struct msg_unit *u, struct team_spec *spec)
{
    spec->sampler.x0 = (int)u->x;
    spec->sampler.y0 = (int)u->y;
    spec->sampler.width = (int)u->width;
    spec->sampler.height = (int)u->height;
    spec->last = rad_quincunx_nbases(&spec->sampler);
}

void
task_begin(struct task *t, const struct team_spec *callbacks,
           struct strict_pass *pass, const struct msg_unit *u)
{
    struct team_spec spec = *callbacks;

    *t = (struct task){ .pass = pass,
                        .mode = pass ? pass->spec.mode : TEAM_TRUTH };
    if (pass) {
        t->unit = unit_of_pass(&spec.sampler, pass);
        t->row0 = (int)t->unit.y;
        spec = pass->spec;
        spec.sampler = callbacks->sampler;
        spec.trace = callbacks->trace;
        spec.paint = callbacks->paint;
        spec.bottom = callbacks->bottom;
        spec.truth.rows = callbacks->truth.rows;
        spec.arg = callbacks->arg;
        spec.cpu_ns = NULL; /* processor time is not measured: time is virtual
                             */
        if (spec.truth.out > spec.first) /* another pass sent these rows */
            t->nrows = t->nsent =
                (uint32_t)(team_line_row(&spec.sampler, spec.truth.out) -
                           t->row0);
    } else {
        t->unit = *u;
        describe_window(u, &spec);
    }
    spec.nthreads = most_members(&spec, callbacks->nthreads);
    t->team = team_new(&spec);
    if (!t->team)
        out_of_memory();
    task_join(t);
}

struct fibre *
task_join(struct task *t)
{
    struct fibre *f = fibre_new(work, t);

    if (!f || !rad_list_grow(&t->fibre, (size_t)t->nfibres, sizeof *t->fibre))
        out_of_memory();
    t->fibre[t->nfibres++] = f;
    t->members++;
    return f;
}

void
task_run(struct task *t)
{
    fibre_run(t->fibre[0]);
}

void
task_yield(struct task *t)
{
    fibre_yield(t->fibre[0]);
}

void
task_look(const struct task *t, struct strict *s)
{
    if (t->team && t->pass)
        strict_look(s, t->pass, t->team);
}

bool
task_end(struct task *t, struct strict *s, struct msg_counts *spent,
         struct msg_counts *total)
{
    struct team_bottom b;
    int finished;

    spent->primary_rays = team_primary(t->team);
    if (!t->pass) {
        *total = *spent;
        return team_done(t->team);
    }
    if (team_blocked(t->team, &finished))
        strict_blocked(t->pass, finished);
    strict_cut(s, t->pass, t->team);
    team_bottom(t->team, &b);
    t->pass->finished = finished;
    return strict_ended(s, t->pass, team_done(t->team), &b, spent, total);
}

void
task_drop(struct task *t, struct strict *s)
{
    const struct team_bottom no_bottom = { 0 };
    const struct msg_counts none = { 0 };

    if (!t->team)
        return;
    t->dropped = true;
    team_stop(t->team);
    for (int i = 0; i < t->nfibres; i++)
        while (fibre_run(t->fibre[i]))
            ;
    if (t->pass)
        strict_ended(s, t->pass, false, &no_bottom, &none, NULL);
    task_release(t);
}

void
task_release(struct task *t)
{
    for (int i = 0; i < t->nfibres; i++)
        fibre_free(t->fibre[i]);
    free(t->fibre);
    team_free(t->team);
    *t = (struct task){ 0 };
}

bool
task_message(struct strict *s, const struct msg *m)
{
    int rc = strict_take(s, m, NULL);

    if (rc < 0)
        abort();
    return rc > 0;
}
