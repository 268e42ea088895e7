/* rif_view.h - the views of a variable file
 *
 * A view has a name of its own or its number, and view options; or it has the
 * name of a standard view: X Y Z x y z and what they make together look at the
 * zone's middle from there, a letter behind says the projection.
 * Source: rad(1); positions and angles are those of Radiance 6.
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_VIEW_H
#define RADD_CLIENT_RIF_VIEW_H

#include "rif/rif_rules.h"

struct rif_view {
    const char *name;
    char **words; /* nwords view options, a NULL behind */
    int nwords;
    int number; /* among those of the file, from 1; 0: none of them */
    int line;   /* 0: of the command line */
};

/* All views, or the one that `which` asks for (NULL: all): a number, a name, a
 * standard view or view options.  Returns how many, in *list, of the arena;
 * RAD_EDATA, RAD_EUSAGE for `which`, RAD_ENOMEM. */
int rif_views(struct rif *r, const struct rif_zone *z, const char *which,
              struct rif_view **list, struct rad_error *err);

#endif
