/* survey.h - an estimate of the costs of a job's areas before its units go out
 *
 * See survey.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SURVEY_H
#define DAEMON_SURVEY_H

#include "desk/desk.h"

struct survey;

void survey_free(struct survey *s);
/* End the job's survey, if it has one: no worker estimates its areas. */
void survey_end(struct job *job);

/* Handler of ESTIMATED. */
void survey_estimated(struct coord *c, struct coord_worker *w,
                      const struct msg *msg);

/* Make job->survey, if the job wants an estimate; 0 or RAD_ENOMEM. */
int survey_begin(struct job *job, uint32_t workers, struct rad_error *err);
/* Send a ready worker areas, or, if the estimate was given up, end it so that
 * units may go out.  False: neither. */
bool survey_give(struct coord *c, struct job *job, uint32_t index);
/* Does the worker estimate areas, or are there some for it? */
bool survey_has(const struct coord *c, const struct job *job, uint32_t index);
/* The worker will not answer: let other workers have its areas. */
void survey_lost(struct job *job, uint32_t index);
/* A child died of a chunk of areas; when a second one does the estimate is
 * given up. */
void survey_crashed(struct coord *c, struct job *job, uint32_t chunk);

#endif
