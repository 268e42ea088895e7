/* strict.h - the strict units of a job's child: what is done next, what is said
 *
 * A strict unit is lines of a frame (team.h); its top is the base line above
 * it, its bottom the last of its own.  Line 0 needs no top.  Until the true top
 * is there, from another worker or another unit here, the unit's pixels are
 * traced ahead, on a guess, and kept as facts; then TRUTH makes the rows over
 * the facts and leaves the top of the unit below.  So a unit has passes, each
 * the work of one team: first LINES, then AHEAD, after which it is parked, and
 * TRUTH as soon as may be.  A bottom that others may wait for comes first: for
 * it a pass ends early, and goes on afterwards.  Of a unit that has time
 * (MSG_UNIT_BARS) LINES makes the bars, too.  Where the unit has several lines
 * and its top is true before all bars are traced, LINES is made (again) for the
 * bottom that others wait for; but for what was guessed from just these
 * densities, which is true then, and without the lines that come out as they
 * were guessed.  TRUTH alone does where the top is true from the start and
 * there is but one line, or nothing below.
 *
 * Columns of a unit's last line may be lent to another worker while they are
 * not begun (LEND, LOAN).  The unit's passes leave them out, and TRUTH, which
 * cannot, ends before them and waits (BACK).  What is lent here is a unit of
 * its own, with a pass that leaves nothing but facts.
 *
 * A unit that is to go back (YIELD) stops at once.  It ends with the rows that
 * the pass had handed on, if that was TRUTH; what is left of it, or all of it,
 * is told as facts and is not its own any more (GAVE).
 *
 * This machine holds units, tops and facts, chooses the passes, takes messages
 * and makes those that go out.  It has no thread, socket or clock: the caller
 * gives the time, runs a team for each pass and says how far it is.
 * Thread: all calls under one lock, but for what teams do with facts. */
#ifndef RADD_DAEMON_STRICT_H
#define RADD_DAEMON_STRICT_H

#include "proto/message.h"
#include "team/team.h"

struct strict;

/* The frames' samplers, each for the whole frame, are copied; their trace is
 * not used.  painted: a base line in the picture may differ from what was
 * sampled.  job is the id for messages.
 * NULL: memory is out. */
struct strict *strict_new(const struct rad_quincunx *frames, uint32_t nframes,
                          bool painted, const uint8_t job[MSG_JOB]);

/* No pass may be under way. */
void strict_free(struct strict *s);

/* 0, or RAD_ENOMEM once memory ran out for what cannot be done without. */
int strict_error(const struct strict *s);

/* --- what comes in ---
 * UNIT: RAD_EPROTO if its rows are no lines of a frame; LOAN: if its columns
 * are not such as a frame has; then they are paid for untraced, and all else
 * goes on.  REVOKE, YIELD, SPLIT, TWIN, LEND and BACK are ignored
 * where they are about nothing that is here; facts and base lines may come
 * before the unit that needs them, and should: it is begun at once. */
int strict_unit(struct strict *s, const struct msg_unit *u,
                struct rad_error *err);
void strict_revoke(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_yield(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_split(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_twin(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_lend(struct strict *s, const struct msg_lend *m);
int strict_loan(struct strict *s, const struct msg_loan *m,
                struct rad_error *err);
void strict_back(struct strict *s, const struct msg_back *m);
void strict_facts(struct strict *s, const struct msg_facts *m);
void strict_base_line(struct strict *s, const struct msg_base_line *m);

/* Time passes: call it after any other call here, be it to say something or
 * that a pass has ended, and again, with strict_look() for all passes, at the
 * time that it gives, if nothing happens before.  STRICT_NEVER: there is
 * nothing that only time will bring. */
#define STRICT_NEVER UINT64_MAX
uint64_t strict_tick(struct strict *s, uint64_t now_ms);

/* Is there something for strict_next() to begin? */
bool strict_has_work(const struct strict *s);

/* --- passes --- */

/* What passes are for, the most urgent first. */
enum strict_rank {
    STRICT_TRUE_LINES, /* LINES, the top being true: others may wait for it */
    STRICT_TRUTH,
    STRICT_LOAN, /* what another worker lends, and waits for */
    STRICT_LINES,
    STRICT_AHEAD
};

/* Work for one team.  After any call above its caller looks at those that are
 * under way: strict_look(), or by hand where there is no team. */
struct strict_pass {
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) of the frame; see strict_shrunk() */
    enum strict_rank rank;
    enum team_mode mode;
    enum team_end end;
    bool true_top;                      /* what follows is true */
    struct rad_pixel *top;              /* NULL: not known */
    uint8_t *top_density;               /* NULL: not known, or none at all */
    int top_known;                      /* see team.h */
    int filled;                         /* with LINES: see team.h */
    uint8_t *record;                    /* see team.h; or NULL */
    const uint8_t *earlier;             /* see team.h; or NULL */
    uint64_t *cpu_ns;                   /* see team.h; or NULL */
    _Atomic(struct rad_facts *) *facts; /* by line of the frame; NULL: none */
    bool stop;                          /* end it: nobody wants it any more */
    bool split;            /* call team_shrink() with strict_least(), and tell
                            * strict_shrunk() */
    int least;             /* the line after the unit's first */
    int finished;          /* lines before it are done; to be said before
                            * strict_ended() */
    struct team_made made; /* how far it is; to be said now and then, and before
                            * strict_ended() */
    int out; /* lines before it were handed on, by a pass that ended early */
    const struct team_loan *loan; /* with TEAM_LOAN */
    struct team_blocks lent;      /* of the last line, from the start */
    double lend;   /* above 0: call team_lend() with it, now and then, until it
                    * lends; tell strict_lent() */
    uint64_t back; /* not 0: call team_back() with it, and set it to 0 */
    bool keeps;    /* all that it traces are facts, so that, having lent, it can
                    * be made again from the top: else it does not lend */
    /* the machine's */
    struct strict_unit *of;
    int sent_columns;
    size_t sent_densities;
};

/* Begin the most urgent pass, none that is less so than `least`; from the top.
 * NULL: there is none.  It is the caller's until strict_ended(). */
struct strict_pass *strict_next(struct strict *s, enum strict_rank least);

/* Say to a team's spec what the pass is; the sampler, callbacks and members are
 * the caller's. */
void strict_describe(const struct strict_pass *p, struct team_spec *spec);

/* Do with the team of a pass what is wanted of it (stop, split, lend, back),
 * and see how far it is: strict_shrunk(), strict_lent() and strict_bottom(). */
void strict_look(struct strict *s, struct strict_pass *p, struct team *t);

/* The line before which a pass gives nothing: one is left of which rows are not
 * out, so that there is a last one. */
int strict_least(const struct strict_pass *p);

/* The team gave its lines from `last` on, none of them begun, or nothing. */
void strict_shrunk(struct strict *s, struct strict_pass *p, int last);

/* The team lends these columns.  As long as it can lend nothing LEND stays to
 * be done. */
void strict_lent(struct strict *s, struct strict_pass *p,
                 const struct team_loan *loan);

/* A team has left TRUTH because columns are lent, with lines before `finished`
 * handed on (team_blocked()); to be said before strict_ended(). */
void strict_blocked(struct strict *s, struct strict_pass *p, int finished);

/* A team has left a pass.  Where its unit is to go back (YIELD), cut the unit
 * to the lines whose rows are handed on (team_cut()); the others go back.  Call
 * it before asking the team for the bottom. */
void strict_cut(struct strict *s, struct strict_pass *p, struct team *t);

/* So many columns and densities of the bottom line of a pass under a true top
 * are final, as in the picture. */
void strict_bottom(struct strict *s, struct strict_pass *p, int columns,
                   size_t densities, const struct rad_pixel *pixels,
                   const uint8_t *density);

/* The team has left the pass, which is gone now.  done: it came to its end;
 * pixels and density are its bottom then.  spent: what it cost, primary rays of
 * TRUTH alone, which count if it came to its end: the pass that goes on has all
 * of them.  True: the unit is done, and *total is what all of it cost; its
 * speculative rays are the facts that nobody wanted. */
bool strict_ended(struct strict *s, struct strict_pass *p, bool done,
                  const struct rad_pixel *pixels, const uint8_t *density,
                  const struct msg_counts *spent, struct msg_counts *total);

/* Is there a unit that can do nothing but wait for its top? */
bool strict_waits(const struct strict *s);

/* Rays of passes that have ended, of units that are not done. */
uint64_t strict_rays(const struct strict *s);

/* Pixels that any pass has gone over, in units whose rows are not handed on:
 * for a display of the progress.  Pixels that several workers go over count for
 * each of them. */
uint64_t strict_pixels(const struct strict *s);

/* What units that were revoked cost in all, as TALLY says it. */
void strict_dropped(const struct strict *s, struct msg_counts *out);

/* --- what goes out --- */

/* The next message, in order; valid until the next call.  NULL: none.  Without
 * room only what others may wait for, not facts for the case of a loss. */
const struct msg *strict_message(struct strict *s, bool room);

#endif
