/* strict.h - the strict units of a job's child: the next pass, messages
 *
 * A strict unit is a run of lines of a frame (team.h); its top is the base line
 * above its first line, its bottom its own last base line.  Line 0 needs no
 * top.  A unit is made in passes, each by one team.  Until the true top comes,
 * from another worker or another unit of this child, pixels are traced ahead on
 * a guess at it, and kept as facts: by LINES, then by AHEAD, after which the
 * unit is parked; and again when a better guess comes.  When the true top is
 * there, TRUTH makes the rows over the facts, and leaves the bottom.
 *
 * Bottoms come before rows, since other units may wait for them.  If the true
 * top comes before all bars are traced, a unit of several lines makes
 * LINES (again) for its bottom.  If the top is true from the start, TRUTH alone
 * does for a unit of one line, or with no unit below.
 *
 * Columns of a unit's last line may be lent to another worker while no thread
 * has begun them (LEND, LOAN).  LINES and AHEAD leave them out; TRUTH ends
 * before these columns, and the unit waits for BACK.  Columns that this child
 * borrows are a unit of their own, with one pass, which only makes facts.
 *
 * A unit that is to be given back (YIELD) stops at once.  It keeps the lines
 * whose rows TRUTH has handed on; the facts of its other lines are sent, and
 * the lines given back (GAVE).
 *
 * The machine holds units, tops and facts, chooses passes, takes messages and
 * makes messages.  It has no thread, socket or clock: the caller tells the
 * time, runs a team for each pass and reports its progress.
 * Thread: all calls under one lock; teams use facts without it. */
#ifndef RADD_DAEMON_STRICT_H
#define RADD_DAEMON_STRICT_H

#include "proto/message.h"
#include "team/team.h"

struct strict;

/* frames: samplers, each of a whole frame, copied; their trace is not used.
 * painted: small sources are painted over base lines, so these may differ from
 * the sampled values.  job: the id for messages.  NULL: memory is out. */
struct strict *strict_new(const struct rad_quincunx *frames, uint32_t nframes,
                          bool painted, const uint8_t job[MSG_JOB]);

/* Free the machine; no pass is under way. */
void strict_free(struct strict *s);

/* RAD_ENOMEM if memory was out where the machine cannot do without, else 0. */
int strict_error(const struct strict *s);

/* --- messages that come ---
 * UNIT: RAD_EPROTO if its rows are no lines of a frame.  LOAN: RAD_EPROTO if no
 * frame has such columns; PAID is sent then, without facts, and the job goes
 * on.  REVOKE, YIELD, SPLIT, LEND and BACK are ignored if the attempt is
 * not here.  Facts, guesses, base lines should come before the unit that needs
 * them, for a unit is begun at once. */
int strict_unit(struct strict *s, const struct msg_unit *u,
                struct rad_error *err);
void strict_revoke(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_yield(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_split(struct strict *s, uint32_t unit, uint32_t attempt);
void strict_lend(struct strict *s, const struct msg_lend *m);
int strict_loan(struct strict *s, const struct msg_loan *m,
                struct rad_error *err);
void strict_back(struct strict *s, const struct msg_back *m);
void strict_facts(struct strict *s, const struct msg_facts *m);
void strict_guess(struct strict *s, const struct msg_guess *m);
void strict_base_line(struct strict *s, const struct msg_base_line *m);

/* Take one of these messages, but UNIT and REVOKE.  Returns 1; 0: the message
 * is none of them; a code: a LOAN failed. */
int strict_take(struct strict *s, const struct msg *m, struct rad_error *err);

/* The frame whose lines a message brings: FACTS, BASE_LINE, GUESS, LOAN.  It
 * may come before the frame's first UNIT.  False: it brings none. */
bool strict_brings(const struct msg *m, uint32_t *frame);

/* Tell the time [ms]; returns when to call again, with strict_look() for all
 * passes, or STRICT_NEVER.  Also call it after any other call that changes the
 * machine. */
#define STRICT_NEVER UINT64_MAX
uint64_t strict_tick(struct strict *s, uint64_t now_ms);

/* Has strict_next() a pass to begin? */
bool strict_has_work(const struct strict *s);

/* --- passes --- */

/* Ranks of passes, the most urgent first. */
enum strict_rank {
    STRICT_TRUE_LINES, /* LINES under a true top, to make the bottom */
    STRICT_TRUTH,
    STRICT_LOAN, /* columns of another worker, which waits for them */
    STRICT_LINES,
    STRICT_AHEAD
};

/* The work of one team.  After any call above the caller calls strict_look()
 * for each pass under way, which carries out what its fields ask for. */
struct strict_pass {
    uint32_t unit, attempt, frame;
    enum strict_rank rank;
    /* For the team, which gets a copy: the caller sets sampler, callbacks and
     * nthreads.  The pass owns tops and record; last: see strict_shrunk(). */
    struct team_spec spec;
    bool stop;                          /* team_stop() is due */
    bool split;            /* team_shrink() is due, then strict_shrunk() */
    int least;             /* the line after the unit's first */
    int finished;          /* lines before this one are done; the caller sets it
                            * before strict_ended() */
    struct team_made made; /* progress; the caller sets it now and then, and
                            * before strict_ended() */
    double lend;   /* above 0: team_lend() of this part is due, until the team
                    * can lend, then strict_lent() */
    uint64_t back; /* not 0: team_back() of these blocks is due */
    bool keeps;    /* all traced pixels are kept as facts, so that another pass
                    * can go over them after a loan; else it does not lend */
    /* the machine's own */
    struct strict_unit *of;
    int sent_columns;
    size_t sent_densities;
};

/* Are spec.top and spec.top_density true? */
static inline bool
strict_has_true_top(const struct strict_pass *p)
{
    return p->rank <= STRICT_TRUTH;
}

/* Begin the most urgent pass, if its rank is at least `least`; of equal ranks
 * that of the topmost unit.  The caller has the pass until strict_ended().
 * NULL: there is none to begin. */
struct strict_pass *strict_next(struct strict *s, enum strict_rank least);

/* Carry out with the pass's team what is due, and report the results to the
 * machine: strict_shrunk(), strict_lent() and strict_bottom(). */
void strict_look(struct strict *s, struct strict_pass *p, struct team *t);

/* The first line that a pass may give away.  It keeps one line whose rows are
 * not handed on, so that its unit ends with this pass. */
int strict_least(const struct strict_pass *p);

/* The team gave away its lines from `last` on, of which none was begun; or no
 * line, if `last` is pass.last. */
void strict_shrunk(struct strict *s, struct strict_pass *p, int last);

/* The team has lent these columns. */
void strict_lent(struct strict *s, struct strict_pass *p,
                 const struct team_loan *loan);

/* A team left TRUTH because columns are lent, after it handed on the rows of
 * lines before `finished` (team_blocked()).  Call this before strict_ended().
 */
void strict_blocked(struct strict_pass *p, int finished);

/* A team left a pass whose unit is to be given back (YIELD): cut the unit after
 * the lines whose rows were handed on (team_cut()), and give the others back.
 * Else do nothing.  Call this before asking the team for the bottom. */
void strict_cut(struct strict *s, struct strict_pass *p, struct team *t);

/* This much of the bottom of a pass under a true top is final, as in the
 * picture: send what was not sent. */
void strict_bottom(struct strict *s, struct strict_pass *p,
                   const struct team_bottom *b);

/* The team has left the pass, which is freed.
 *   done     the pass came to its end, and so b is its whole bottom
 *   spent    the pass's cost; its primary rays count only if TRUTH is done, for
 *            they are those of the whole unit
 * True: the unit is done, and *total is the cost of all its passes; speculative
 * rays are facts that no row needed. */
bool strict_ended(struct strict *s, struct strict_pass *p, bool done,
                  const struct team_bottom *b, const struct msg_counts *spent,
                  struct msg_counts *total);

/* Is there a unit that can only wait for its top? */
bool strict_waits(const struct strict *s);

/* Rays of passes that have ended, of units that are not done. */
uint64_t strict_rays(const struct strict *s);

/* Pixels that passes have gone over, of rows that are not handed on: to show
 * progress. */
uint64_t strict_pixels(const struct strict *s);

/* The cost of all units that were taken or given back unfinished, for TALLY. */
void strict_dropped(const struct strict *s, struct msg_counts *out);

/* --- messages that go --- */

/* The next message, valid until the next call; NULL: none.  Without room no
 * lazy ones: facts that only matter if this worker is lost. */
const struct msg *strict_message(struct strict *s, bool room);

#endif
