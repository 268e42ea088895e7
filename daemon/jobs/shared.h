/* shared.h - facts and base lines that the coordinator keeps
 *
 * Facts are kept of lines that are not done, for the worker that gets such a
 * line next.  Base lines are kept that lie above units which are not done, in
 * pieces as they came.  The coordinator checks that facts and base lines fit
 * the picture; it does not check their values.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SHARED_H
#define DAEMON_SHARED_H

#include "proto/message.h"

/* Most bytes of facts that are kept for one job.  Further facts are dropped:
 * workers trace their pixels again. */
#define SHARED_MAX_FACTS ((size_t)512 << 20)

struct shared;

/* For frames of these sizes, with channels floats a pixel, sampled with -ps
 * psample.  NULL: memory is out. */
struct shared *shared_new(const struct msg_frame *frames, uint32_t nframes,
                          int psample, uint8_t channels);
void shared_free(struct shared *s);

/* The number of lines of a frame. */
uint32_t shared_nlines(const struct shared *s, uint32_t frame);

/* --- facts --- */

/* Do the facts lie in a line of a frame? */
bool shared_facts_fit(const struct shared *s, const struct msg_facts *m);

/* Are the columns of a LOAN whole blocks of a line that has a bar, and has the
 * message the densities that the line needs? */
bool shared_loan_fits(const struct shared *s, const struct msg_loan *m);

/* Keep a copy of facts, if there is room.  Returns how many of their pixels
 * were traced twice: facts of these pixels came before, since the line's facts
 * were last dropped.  For facts of an estimate 0. */
uint32_t shared_put_facts(struct shared *s, const struct msg_facts *m);

/* Walk the facts of a line, message by message, in the order in which the
 * messages came.  *at is NULL at first.  False: there are no more.  Pointers of
 * *m are valid until the line's facts are dropped; the caller sets m->job. */
struct shared_facts;
bool shared_get_facts(const struct shared *s, uint32_t frame, uint32_t line,
                      const struct shared_facts **at, struct msg_facts *m);
/* Do the facts have pixels of the line's base line, and come from no estimate?
 */
bool shared_of_base(const struct shared *s, const struct msg_facts *m);

/* Does the guess fit a line that has another below? */
bool shared_guess_fits(const struct shared *s, const struct msg_guess *m);
/* Keep a guess, if it follows from more lines than the guess that is kept;
 * false: it was not kept. */
bool shared_put_guess(struct shared *s, const struct msg_guess *m);
/* Fill in *m, but for m->job, with the guess that is kept for a line; false:
 * there is none.  m->density is valid until the line's facts are dropped or a
 * better guess comes. */
bool shared_get_guess(const struct shared *s, uint32_t frame, uint32_t line,
                      struct msg_guess *m);

/* Drop the facts of a line, and the guess at its densities. */
void shared_drop_facts(struct shared *s, uint32_t frame, uint32_t line);

/* --- base lines --- */

/* Does the piece lie in a base line of a frame? */
bool shared_base_fits(const struct shared *s, const struct msg_base_line *m);

/* Add a piece of a base line; a piece that would leave a gap is ignored.  True:
 * this piece made the line whole. */
bool shared_put_base(struct shared *s, const struct msg_base_line *m,
                     uint64_t now_ms);

/* Put into *m the next piece of a base line, from column *x and density *first
 * on, and move *x and *first behind it (shelf.h); false: there is no more.
 * Pointers of *m are valid until the base line is dropped. */
bool shared_get_base(const struct shared *s, uint32_t frame, uint32_t line,
                     uint32_t *x, uint32_t *first, struct msg_base_line *m);

/* The number of densities of a base line of the frame. */
uint32_t shared_ndensity(const struct shared *s, uint32_t frame);
/* The densities, or the pixels, of a base line; NULL: it is not whole. */
const uint8_t *shared_densities(const struct shared *s, uint32_t frame,
                                uint32_t line);
const uint8_t *shared_pixels(const struct shared *s, uint32_t frame,
                             uint32_t line);

/* When the base line became whole; 0: it is not whole. */
uint64_t shared_whole_ms(const struct shared *s, uint32_t frame, uint32_t line);
void shared_drop_base(struct shared *s, uint32_t frame, uint32_t line);

/* Drop all facts and base lines of a frame. */
void shared_drop_frame(struct shared *s, uint32_t frame);

#endif
