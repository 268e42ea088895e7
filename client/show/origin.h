/* origin.h - where a picture is from, as lines of its header
 *
 * So that a picture can be told a year later: the names of the scene's files
 * without their folders (SCENE=), or, of an octree, its name and the lines of
 * its own header, which say how it was made.  These depend on the command line
 * and the octree alone, as a picture's bytes do; with a stamp the day, the host
 * and the job are added.
 * Thread: one. */
#ifndef RADD_CLIENT_ORIGIN_H
#define RADD_CLIENT_ORIGIN_H

#include "proto/message.h"

#include <time.h>

/* What --stamp adds: CAPDATE, in the local time, and GMT, as Radiance writes
 * them; HOST; JOB. */
struct origin_stamp {
    time_t now;
    const char *host;
    const uint8_t *job; /* id, MSG_JOB bytes */
};

/* Put the lines into text, each with its newline, printable and cut to fit;
 * stamp may be NULL. */
void origin_text(char text[MSG_MAX_ORIGIN + 1], const char *const *scenes, int n,
                 const struct origin_stamp *stamp);

#endif
