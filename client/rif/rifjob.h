/* rifjob.h - a job from rad's variable file
 *
 * The scene first (rifjob_begin), since standard views and some options depend
 * on its size; then the command line is read once more with the file's options
 * before its own (rifjob_finish), so that these overrule.  All views are
 * frames of one job, with a name each.
 * What rad would do and this does not is noted, a line each.
 * Thread: one. */
#ifndef RADD_CLIENT_RIFJOB_H
#define RADD_CLIENT_RIFJOB_H

#include "job/frames.h"
#include "rif/rif_view.h"
#include "job/submit_options.h"
#include "common/words.h"

struct rifjob {
    bool is; /* there is such a file */
    struct rif rif;
    char **scenes; /* nscenes files and commands */
    int nscenes;
    double exposure;           /* of pictures in .hdr; 0: radiance as it is */
    bool raw;                  /* pictures as rpict makes them */
    struct frames_view *views; /* nviews */
    int nviews;
    const char **notes; /* nnotes lines for the user */
    int nnotes;
    const char *optfile; /* what rad puts into OPTFILE */
    struct words given;  /* the command line as it was, */
    int ngiven;          /* of which so many words come before the file */
};

/* Read the file that is o's first scene, and the assignments behind it; then
 * o's scenes are the file's.  Nothing happens where it is no .rif file.
 * RAD_ENOINPUT, RAD_EDATA, RAD_EUSAGE, RAD_EUNSUPPORTED (photon maps). */
int rifjob_begin(struct rifjob *j, struct submit_options *o, struct words *w,
                 struct rad_error *err);

/* Make *o anew, of the file and of the words in *w, which become those that it
 * points to.  t is the scene's octree. */
int rifjob_finish(struct rifjob *j, struct submit_options *o, struct words *w,
                  const struct rad_octree *t, struct rad_error *err);

/* What is done beside the pictures when the job is about to begin: OPTFILE is
 * written, and an AMBFILE that is older than the scene removed, as rad does. */
int rifjob_prepare(struct rifjob *j, const struct submit_options *o,
                   struct rad_error *err);

void rifjob_release(struct rifjob *j);

#endif
