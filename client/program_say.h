/* program_say.h - messages of radsubmit to the user, on standard error */
#ifndef RADD_CLIENT_PROGRAM_SAY_H
#define RADD_CLIENT_PROGRAM_SAY_H

#include "program.h"

/* Print a line on standard error: news unless this is in the place of rpict or
 * rtrace, which have none without -t; a warning unless -w- is given. */
void program_say(void *program, const char *text);
void program_news(struct program *p, const char *text);
void program_warn(struct program *p, const char *text);
/* Options that are taken otherwise than they were given. */
void program_warn_of_options(struct program *p);
/* Frames of --no-clobber whose exposure is not that of the frames there. */
void program_warn_of_rest(struct program *p);
void program_warn_of_scene(struct program *p);
/* Tell what rad would do and radsubmit does not, each note once. */
void program_warn_of_rif(struct program *p);

/* The exit status after a failure, radsubmit's or, in its place, rpict's. */
int program_status(const struct program *p, int rc);

/* Show a report of progress (submit.h), and say what holds the job up. */
void program_on_progress(void *program, const struct msg_progress *m);

/* At the end of each job: warn of pixels that were no numbers, and sum up. */
void program_end_job(struct program *p);
/* At the end of all: warn of pictures that are all black without bad pixels, of
 * functions that failed.  Then the last line. */
void program_warn_of_dark(struct program *p);
void program_warn_of_faults(struct program *p);
void program_say_done(struct program *p);
/* Take from the job's statistics, JSON, what --error or --time have reached. */
void program_note_goal(struct program_goal *g, const uint8_t *json, size_t len);

#endif
