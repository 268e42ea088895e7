/* outcome.c - see outcome.h */
#include "config.h"

#include "trial/outcome.h"

#include <math.h>
#include <string.h>

void
outcome_note(struct outcome *o, const struct msg_progress *m)
{
    o->elapsed_s = m->elapsed_s;
    o->error = m->error;
    o->left_out = m->left_out;
    o->nan = m->nan;
    memcpy(o->faults, m->faults, sizeof o->faults);
}

void
outcome_add(struct outcome_sum *s, const struct outcome *job, double weight)
{
    s->all.elapsed_s = fmax(s->all.elapsed_s, s->before_s + job->elapsed_s);
    if (job->error > 0 || job->left_out > 0) {
        s->squares += weight * job->error * job->error;
        s->left_out += weight * job->left_out;
        s->weight += weight;
        s->all.error = sqrt(s->squares / s->weight);
        s->all.left_out = s->left_out / s->weight;
    }
    msg_nan_add(&s->all.nan, &job->nan);
    msg_faults_add(s->all.faults, job->faults);
}

void
outcome_next(struct outcome_sum *s)
{
    s->before_s = s->all.elapsed_s;
}
