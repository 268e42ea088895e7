/* team_member.h - one member of a team, at work on one line
 *
 * Private to team*.c; see team_impl.h.
 * Thread: the member's own. */
#ifndef DAEMON_TEAM_MEMBER_H
#define DAEMON_TEAM_MEMBER_H

#include "team/team_impl.h"

/* One member at work on one line. */
struct member {
    struct team *team;
    struct rad_ctx *ctx;
    struct rad_quincunx q;
    int i;
    _Atomic(struct rad_facts *) *facts; /* of line i; NULL: never any */
    int row0;                           /* the first of line i */
    bool truth;  /* pixels traced now are sure to be wanted */
    bool early;  /* or will be, and counts then */
    int row;     /* of line i's base line, in the picture */
    int ahead;   /* the first gap that was traced before it slept */
    bool unsure; /* of the colours that the bar is filled between */
    uint64_t mine[NPART]; /* blocks of line i that this member began */
    uint64_t told;        /* of count(ctx) */
    uint64_t traced, primary;
    uint64_t looked; /* traced when the rays were last counted */
};

/* The facts of the member's line; NULL: there are none. */
static inline struct rad_facts *
facts_of(const struct member *m)
{
    return m->facts ? atomic_load_explicit(m->facts, memory_order_acquire)
                    : NULL;
}

static inline const uint8_t *
density_above(const struct member *m)
{
    const struct team *t = m->team;

    if (t->ndensity == 0)
        return NULL;
    return m->i > t->spec.first ? line_at(t, m->i - 1)->density : t->density;
}

/* --- team_member.c --- */

/* A member of the team, at no line yet. */
void member_init(struct member *m, struct team *t, struct rad_ctx *ctx);
/* Wait until `need` densities of the line above are final, or it is painted;
 * false: stopped. */
bool member_wait(const struct member *m, size_t need);
/* Set how many densities of the line are final, and wake the member below if it
 * waits for them. */
void member_publish(struct team *t, struct line *l, size_t ready);
/* Add the member's new rays to the team's, if they are many; called often. */
void member_tell_rays(struct member *m);
/* Add all of the member's new rays to the team's. */
void member_tell_all(struct member *m);
/* Are the colours above its bar sampled with too little known of the densities?
 */
bool member_is_unsure(const struct member *m);
/* The rows of the member's line, and of the base line above, for the bar. */
void member_bar_rows(const struct member *m, struct rad_pixel *rows[]);
/* Fill columns up to `end` of the member's bar; false: stopped. */
bool member_fill(struct member *m, struct rad_pixel *const rows[],
                 struct rad_quincunx_fill *s, int end);
/* Does the truth want column x of line i's bar, though little is known of the
 * densities? */
bool member_bar_is_certain(const struct team *t, int i,
                           struct rad_pixel *const rows[], int x);

/* --- team_sweep.c --- */

/* Is the block the member's to trace?  Not if it is lent. */
bool sweep_claim(struct member *m, enum part part, int b);
/* Trace the member's base line ahead; false: stopped. */
bool sweep_line(struct member *m);
/* Trace these blocks of the bar with these rows ahead; false: stopped. */
bool sweep_bar(struct member *m, struct rad_pixel *const rows[],
               uint64_t blocks);

#endif
