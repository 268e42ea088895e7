/* strict.h - the strict units of a job's child: the next pass, messages
 *
 * A strict unit is a run of lines of a frame (team.h); its top is the base line
 * above its first line, its bottom its own last base line.  Line 0 needs no
 * top.  A unit has passes, each the work of one team.  Until the true top
 * comes, from another worker or another unit here, pixels are traced ahead, on
 * a guess, and kept as facts: by a pass of LINES, then of AHEAD, after which
 * the unit is parked.  With the true top TRUTH makes the rows, over the facts,
 * and leaves the top of the unit below.
 *
 * Bottoms come before rows, since other units may wait for them: a pass that
 * makes rows ends early for a bottom, and goes on afterwards.  So a unit of
 * several lines whose top is true before all bars are traced has LINES made
 * (again) for its bottom, up to where densities come out as guessed.  If the top
 * is true from the start TRUTH alone does for a unit of one line, or with no unit
 * below.  With MSG_UNIT_BARS LINES makes the bars, too.
 *
 * Columns of a unit's last line may be lent to another worker while no thread
 * has begun them (LEND, LOAN).  LINES and AHEAD leave them out; TRUTH ends
 * before these columns, and the unit waits for BACK.  Columns that this child
 * borrows are a unit of their own, with one pass that leaves facts alone.
 *
 * A unit that is to go back (YIELD) stops at once.  It keeps the lines whose
 * rows TRUTH has handed on; its other lines are sent as facts and given back
 * (GAVE).
 *
 * This machine holds units, tops and facts, chooses passes, takes messages and
 * makes messages.  It has no thread, socket or clock: the caller gives the
 * time, runs a team for each pass and reports the pass's progress.
 * Thread: all calls under one lock, except that teams use facts without. */
#ifndef RADD_DAEMON_STRICT_H
#define RADD_DAEMON_STRICT_H

#include "proto/message.h"
#include "team/team.h"

struct strict;

/* The frames' samplers, each for the whole frame, are copied; their trace is
 * not used.  painted: a base line in the picture may differ from the sampled
 * values (small sources are painted over it).  job is the id for messages.
 * NULL: memory is out. */
struct strict *strict_new(const struct rad_quincunx *frames, uint32_t nframes,
                          bool painted, const uint8_t job[MSG_JOB]);

/* No pass may be under way. */
void strict_free(struct strict *s);

/* RAD_ENOMEM if memory for an indispensable step ran out, else 0. */
int strict_error(const struct strict *s);

/* --- messages that come in ---
 * UNIT: RAD_EPROTO if its rows are no lines of a frame.  LOAN: RAD_EPROTO if no
 * frame has such columns; the loan is then paid for untraced, and the job goes
 * on.  REVOKE, YIELD, SPLIT, TWIN, LEND and BACK of an attempt that is not here
 * are ignored.  Facts and base lines should come before the unit that needs
 * them, which is begun at once. */
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

/* Tell the time.  To be called after any other call that changes the machine;
 * and, with strict_look() for all passes, at the time that strict_tick()
 * returned, unless there was another call before.  STRICT_NEVER: nothing waits
 * for a time. */
#define STRICT_NEVER UINT64_MAX
uint64_t strict_tick(struct strict *s, uint64_t now_ms);

/* Is there something for strict_next() to begin? */
bool strict_has_work(const struct strict *s);

/* --- passes --- */

/* How urgent passes are, the most urgent first. */
enum strict_rank {
    STRICT_TRUE_LINES, /* LINES under a true top, for the bottom */
    STRICT_TRUTH,
    STRICT_LOAN, /* columns of another worker, which waits for them */
    STRICT_LINES,
    STRICT_AHEAD
};

/* Work for one team.  After any call above the caller does for each pass under
 * way what the fields below ask for, by strict_look(). */
struct strict_pass {
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) of the frame; see strict_shrunk() */
    enum strict_rank rank;
    enum team_mode mode;
    enum team_end end;
    bool true_top;                      /* top and top_density are true */
    struct rad_pixel *top;              /* NULL: not known */
    uint8_t *top_density;               /* NULL: not known, or none at all */
    int top_known;                      /* see team.h */
    int filled;                         /* with LINES: see team.h */
    uint8_t *record;                    /* this and the next: see team.h */
    const uint8_t *earlier;
    uint64_t *cpu_ns;                   /* see team.h; or NULL */
    _Atomic(struct rad_facts *) *facts; /* by line of the frame; NULL: none */
    bool stop;                          /* the team is to leave the pass */
    bool split;            /* call team_shrink() with strict_least(), and tell
                            * strict_shrunk() */
    int least;             /* the line after the unit's first */
    int finished;          /* lines before this one are done; set by the caller
                            * before strict_ended() */
    struct team_made made; /* progress; set by the caller now and then, and
                            * before strict_ended() */
    int out; /* lines before this one were handed on by an earlier pass */
    const struct team_loan *loan; /* with TEAM_LOAN */
    struct team_blocks lent;      /* of the last line, from the start */
    double lend;   /* above 0: call team_lend() with this number, now and then,
                    * until the team lends; then call strict_lent() */
    uint64_t back; /* not 0: call team_back() with this number, set it to 0 */
    bool keeps;    /* keeps all traced pixels as facts, so another pass can go
                    * over them after a loan; else the pass does not lend */
    /* the machine's */
    struct strict_unit *of;
    int sent_columns;
    size_t sent_densities;
};

/* Begin the most urgent pass, of rank `least` or above; of equal ones, that of
 * the topmost unit.  The pass is the caller's until strict_ended().  NULL:
 * there is none to begin. */
struct strict_pass *strict_next(struct strict *s, enum strict_rank least);

/* Write the pass into a team's spec, but for sampler, callbacks and members,
 * which are the caller's. */
void strict_describe(const struct strict_pass *p, struct team_spec *spec);

/* Carry out stop, split, lend and back of a pass with its team, and report the
 * results: strict_shrunk(), strict_lent() and strict_bottom(). */
void strict_look(struct strict *s, struct strict_pass *p, struct team *t);

/* The first line that a pass may give away: the pass keeps a line whose rows
 * are not out, so that its unit has a last line. */
int strict_least(const struct strict_pass *p);

/* The team gave its lines from `last` on, none of them begun; or no line, if
 * `last` is the pass's. */
void strict_shrunk(struct strict *s, struct strict_pass *p, int last);

/* The team lends these columns.  Until a team can, pass->lend stays set. */
void strict_lent(struct strict *s, struct strict_pass *p,
                 const struct team_loan *loan);

/* A team has left TRUTH because columns are lent; it has handed on the lines
 * before `finished` (team_blocked()).  Call this before strict_ended(). */
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

/* The team has left the pass, which is freed.
 *   done     the pass came to its end, with this bottom: pixels and density
 *   spent    the pass's cost; its primary rays, if it is TRUTH, count only if
 *            done, for the pass that goes on has all of them
 * True: the unit is done, and *total is the cost of all its passes; speculative
 * rays are the facts that no row needed. */
bool strict_ended(struct strict *s, struct strict_pass *p, bool done,
                  const struct rad_pixel *pixels, const uint8_t *density,
                  const struct msg_counts *spent, struct msg_counts *total);

/* Is there a unit that can do nothing but wait for its top? */
bool strict_waits(const struct strict *s);

/* Rays of passes that have ended, of units that are not done. */
uint64_t strict_rays(const struct strict *s);

/* Pixels that any pass has gone over, in units whose rows are not handed on:
 * for a display of the progress. */
uint64_t strict_pixels(const struct strict *s);

/* The cost of all units that were revoked, for TALLY. */
void strict_dropped(const struct strict *s, struct msg_counts *out);

/* --- messages that go out --- */

/* The next message, in order; valid until the next call; NULL: none.  Without
 * room only what other workers may wait for, no facts for the case of a loss. */
const struct msg *strict_message(struct strict *s, bool room);

#endif
