/* origin.h - header lines that say what a picture was made from
 *
 * By these a picture can be identified a year later: the names of the scene's
 * files without their folders (SCENE=); or an octree's name and the lines of
 * its header, which say how it was made.  They depend only on the command line
 * and the octree, so a picture's bytes do, too.  A stamp adds the day, the host
 * and the job.
 * Thread: one. */
#ifndef RADD_CLIENT_ORIGIN_H
#define RADD_CLIENT_ORIGIN_H

#include "proto/message.h"

#include <time.h>

/* What --stamp adds: CAPDATE, in local time, and GMT, as Radiance writes them;
 * HOST; JOB. */
struct origin_stamp {
    time_t now;
    const char *host;
    const uint8_t *job; /* id, MSG_JOB bytes */
};

/* Write the lines into text, each with its newline, printable and cut to fit.
 * stamp may be NULL. */
void origin_text(char text[MSG_MAX_ORIGIN + 1], const char *const *scenes,
                 int n, const struct origin_stamp *stamp);

#endif
