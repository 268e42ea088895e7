/* surroundings.h - how much larger is a scene than what its pictures show?
 *
 * -ar and the zones of ambient values go by the size of the scene's cube.
 * Where a room stands on a ground of 10 km that says nothing about the room.
 * So a few primary rays of each view tell how large is what they meet, before
 * the job is submitted, as ZONE tells rad.
 * Thread: any. */
#ifndef RADD_CLIENT_SURROUNDINGS_H
#define RADD_CLIENT_SURROUNDINGS_H

#include "points/points.h"
#include "proto/message.h"
#include "scene/scene.h"

struct surroundings {
    double cube;  /* side of the cube about all surfaces */
    double shown; /* diameter of the smallest ball that has most of what a view
                   * meets; the least of all views.  0: not known */
    double lo[3], hi[3]; /* of a box that holds these balls */
};

/* What is shown. */
struct surroundings_of {
    const struct msg_frame *frames; /* n of them */
    uint32_t n;
    const struct rad_points *points; /* instead of frames; or NULL */
};

/* Find them.  RAD_ENOMEM, or RAD_EDATA for a scene that cannot be traced. */
int surroundings_find(struct surroundings *s, const struct rad_scene *scene,
                      const struct surroundings_of *of, struct rad_error *err);

/* The value for --surroundings: a power of four, for views side by side are to
 * have the same; 0: the scene is not much larger. */
int surroundings_times(const struct surroundings *s);

/* Set *ball to centre and radius of a ball that holds what is shown, and all
 * eyes of the frames, or all sensor points, as --shown has them; radius 0:
 * that is not known.  RAD_EDATA: a frame's view is none. */
int surroundings_place(const struct surroundings *s,
                       const struct surroundings_of *of, double ball[4],
                       struct rad_error *err);

/* Is the least radius that -ar gives too large for what is shown? */
bool surroundings_blur(const struct surroundings *s, int ambres);

/* -ar, for a scene that is so many times as large. */
int surroundings_ambres(int times, int ambres);

#endif
