/* team_member.h - one member of a team at work on one line; private to team*.c
 *
 * Thread: the member's. */
#ifndef DAEMON_TEAM_MEMBER_H
#define DAEMON_TEAM_MEMBER_H

#include "team/team_impl.h"

struct member {
    struct team *team;
    struct rad_ctx *ctx;
    struct rad_quincunx q;
    int i;                              /* its line */
    int row0;                           /* first row of the line */
    bool truth;  /* pixels traced now are wanted by the true sampler */
    bool early;  /* pixels traced now count when the line comes to them */
    bool helps;  /* the line is another member's */
    int row;     /* of the line's base line, in the picture */
    int ahead;   /* the first gap that was traced before the member slept */
    bool unsure; /* member_is_unsure() of the line */
    uint64_t mine[LINE_PARTS]; /* blocks of the line that this member began */
    uint64_t begun_early; /* blocks of the base line, see help_claim_early() */
    uint64_t told;        /* rays that were added to the team's */
    uint64_t traced;      /* pixels traced */
    uint64_t primary;     /* pixels wanted by the true sampler */
    uint64_t looked;      /* traced when rays were last compared with told */
};

static inline const uint8_t *
density_above(const struct member *m)
{
    const struct team *t = m->team;

    if (t->ndensity == 0)
        return NULL;
    return m->i > t->spec.first ? line_at(t, m->i - 1)->density : t->density;
}

/* --- team_member.c --- */

/* A member of the team, without a line yet. */
void member_init(struct member *m, struct team *t, struct rad_ctx *ctx);
/* Set the member to work on line i. */
void member_set_line(struct member *m, int i);
/* Wait until `need` densities of the line above are final (ndensity + 1: and it
 * is painted); false: the team is stopped. */
bool member_wait(const struct member *m, size_t need);
/* Set how many densities of line l are final, and wake the member below if that
 * is what it waits for. */
void member_publish(struct team *t, struct line *l, size_t ready);
/* Add the member's new rays to the team's, if there are many; called often. */
void member_tell_rays(struct member *m);
/* Add all of the member's new rays to the team's. */
void member_tell_all(struct member *m);
/* Was the base line above the member's bar sampled with too little known of the
 * densities? */
bool member_is_unsure(const struct member *m);
/* The rows for filling the bar: the base line above, the bar's, and the line's
 * own as sampled. */
void member_bar_rows(const struct member *m, struct rad_pixel *rows[]);
/* Fill columns up to `end` of the member's bar; false: the team is stopped. */
bool member_fill(struct member *m, struct rad_pixel *const rows[],
                 struct rad_quincunx_fill *s, int end);
/* Will TRUTH want column x of line i's bar, though little is known of the
 * densities? */
bool member_bar_is_certain(const struct team *t, int i,
                           struct rad_pixel *const rows[], int x);

/* --- team_sweep.c --- */

/* Claim block b for the member; false: it is lent, or a helper has it. */
bool sweep_claim(struct member *m, enum line_part part, int b);
/* Trace the member's base line ahead; false: the team is stopped. */
bool sweep_line(struct member *m);
/* Trace these blocks of the member's bar ahead; false: the team is stopped. */
bool sweep_bar(struct member *m, struct rad_pixel *const rows[],
               uint64_t blocks);
/* Trace block b of the member's base line into line[], or into facts alone
 * (NULL); or of its bar. */
void sweep_base_block(struct member *m, int b, struct rad_pixel *line);
void sweep_bar_block(struct member *m, struct rad_pixel *const rows[], int b);

/* --- team_help.c --- */

/* Trace a block of a line that another member is at; false: there is none. */
bool help_with_block(struct member *m);
/* Claim block b for the member, or wait until a helper has done it; false: it
 * is lent, or the team is stopped. */
bool help_claim(struct member *m, enum line_part part, int b);
/* Claim the gap's block of the base line to trace pixels early: no helper gets
 * it, and it counts as one that a helper did, to which the member still comes.
 * False: a helper has it, or it is lent. */
bool help_claim_early(struct member *m, int gap);
/* Wait until helpers have done the blocks of the member's base line that they
 * took, and put these into the line; false: the team is stopped. */
bool help_await_base(struct member *m);

#endif
