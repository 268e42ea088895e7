/* program_scene.h - radsubmit's scene, compiled from the user's files
 *
 * It is compiled on a thread of libuv's pool, so that a signal can end the
 * program meanwhile; the thread has p->scene, p->words.inputs, p->frames
 * and p->err for itself until it is done. */
#ifndef RADD_CLIENT_PROGRAM_SCENE_H
#define RADD_CLIENT_PROGRAM_SCENE_H

#include "program.h"

/* If the scene is a file of rad's variables compile its scene now, for options
 * and views depend on its size; then *p is as if the command line had named
 * them. */
int program_take_rif(struct program *p);

/* Compile the scene; with --dry-run predict the job, too.  An interrupt ends
 * the whole program. */
int program_compile(struct program *p);

#endif
