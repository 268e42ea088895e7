/* survey.h - an estimate of the costs of a job's parts, under way
 *
 * See survey.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SURVEY_H
#define DAEMON_SURVEY_H

#include "desk/desk.h"

struct survey;

void survey_free(struct survey *s);

/* A message of a worker. */
void survey_estimated(struct coord *c, struct coord_worker *w,
                      const struct msg *msg);

/* Estimate costs first, if the job wants it; 0 or RAD_ENOMEM. */
int survey_begin(struct job *job, uint32_t workers, struct rad_error *err);
/* Areas for a worker that is ready, or units if the estimate was given up;
 * false: there is neither. */
bool survey_give(struct coord *c, struct job *job, uint32_t index);
/* Has the estimate areas for the worker, or is the worker at some? */
bool survey_has(const struct coord *c, const struct job *job, uint32_t index);
/* The worker is told to answer at once, with the pixels that it has traced;
 * called before rest_ms is set. */
void survey_rest(struct job *job, uint32_t index);
/* Has the worker, which leaves, yet to send the pixels that it has traced? */
bool survey_tells(const struct coord *c, const struct coord_worker *w);
/* The worker will not answer. */
void survey_lost(struct job *job, uint32_t index);
/* A child died of that chunk of areas: the second time the estimate is given
 * up, and units go out as without one. */
void survey_crashed(struct coord *c, struct job *job, uint32_t chunk);

#endif
