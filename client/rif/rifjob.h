/* rifjob.h - a job from rad's variable file
 *
 * First the scene is found (rifjob_begin), since standard views and some
 * options depend on its size.  Then the command line is parsed again, with the
 * file's options ahead of its own (rifjob_finish), so that its own prevail.
 * All views are frames of one job, each with a name.
 * What rad would do and radsubmit does not is noted, a line each.
 * Thread: one. */
#ifndef RADD_CLIENT_RIFJOB_H
#define RADD_CLIENT_RIFJOB_H

#include "job/frames.h"
#include "rif/rif_view.h"
#include "job/submit_options.h"
#include "common/words.h"

struct rifjob {
    bool is; /* the scene is a variable file */
    struct rif rif;
    char **scenes; /* nscenes files and commands */
    int nscenes;
    double exposure;           /* of .hdr pictures; 0: values are radiance */
    struct rif_zone zone;      /* what is looked at */
    bool raw;                  /* pictures are rpict's, not filtered */
    struct frames_view *views; /* nviews */
    int nviews;
    const char **notes; /* nnotes warnings for the user */
    int nnotes;
    const char *optfile; /* content of OPTFILE as rad writes it */
    struct words given;  /* the real command line */
    int ngiven;          /* words of `given` before the file */
};

/* Read the file that is o's first scene, and the assignments after it; o's
 * scenes become those of the file.  Nothing is done if that is not a .rif file.
 * RAD_ENOINPUT, RAD_EDATA, RAD_EUSAGE, RAD_EUNSUPPORTED (photon maps). */
int rifjob_begin(struct rifjob *j, struct submit_options *o, struct words *w,
                 struct rad_error *err);

/* Parse all again into *o: the file's options and the words of *w.  *w becomes
 * the words that *o points to.  t: the scene's octree. */
int rifjob_finish(struct rifjob *j, struct submit_options *o, struct words *w,
                  const struct rad_octree *t, struct rad_error *err);

/* Called before the job begins: write OPTFILE, and remove an AMBFILE that is
 * older than the scene, as rad does. */
int rifjob_prepare(struct rifjob *j, const struct submit_options *o,
                   struct rad_error *err);

void rifjob_release(struct rifjob *j);

#endif
