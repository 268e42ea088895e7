/* rif_view.h - the views of a variable file
 *
 * A view has a name, or else its number, and view options.  Or its name is that
 * of a standard view: X, Y, Z, x, y, z or several of these look at the zone's
 * middle from that side, and a further letter chooses the projection.
 * Source: rad(1); positions and angles of Radiance 6.
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_VIEW_H
#define RADD_CLIENT_RIF_VIEW_H

#include "rif/rif_rules.h"

struct rif_view {
    const char *name;
    char **words; /* nwords view options and a NULL */
    int nwords;
    int number; /* in the file, from 1; 0: not of the file, or its only view */
    int line;   /* 0: from the command line */
};

/* Get all views; or the one of `which`, which is a number, a name, a standard
 * view or view options.  Returns how many there are, in *list, in the arena;
 * RAD_EDATA; RAD_EUSAGE: `which` is wrong; RAD_ENOMEM. */
int rif_views(struct rif *r, const struct rif_zone *z, const char *which,
              struct rif_view **list, struct rad_error *err);

#endif
