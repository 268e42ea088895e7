/* survey.h - an estimate of what a job's parts cost, under way
 *
 * See survey.c; what the scheduler does with it is in sched.h. */
#ifndef DAEMON_SURVEY_H
#define DAEMON_SURVEY_H

struct survey;

void survey_free(struct survey *s);

#endif
