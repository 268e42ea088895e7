/* shared.h - what the coordinator remembers of lines: facts, and base lines
 *
 * Facts of lines that are not done, for whoever gets them next, and the base
 * lines above units that are not done, in pieces as they came.  Their values
 * are the workers' affair; here it is only seen to that they fit the picture.
 * Thread: one. */
#ifndef DAEMON_SHARED_H
#define DAEMON_SHARED_H

#include "proto/message.h"

/* Most bytes of facts that are kept of one job.  More are not kept: what is
 * lost is traced again. */
#define SHARED_MAX_FACTS ((size_t)512 << 20)

struct shared;

/* For pictures of that many channels at -ps psample.  NULL: memory is out. */
struct shared *shared_new(const struct msg_frame *frames, uint32_t nframes,
                          int psample, uint8_t channels);
void shared_free(struct shared *s);

uint32_t shared_nlines(const struct shared *s, uint32_t frame);

/* --- facts --- */

/* Do they fit a line of a frame? */
bool shared_facts_fit(const struct shared *s, const struct msg_facts *m);

/* Are a LOAN's columns whole blocks of a line that has a bar, with what it
 * takes to trace them? */
bool shared_loan_fits(const struct shared *s, const struct msg_loan *m);

/* Keep a copy of facts, if there is room.  Returns how many of these pixels
 * came before, since the line was dropped last, and so were traced twice; 0 of
 * estimates. */
uint32_t shared_put_facts(struct shared *s, const struct msg_facts *m);

/* The facts of a line, one message after the other, in the order in which they
 * came: *at is NULL at first.  False: there are no more.  What m points at is
 * valid until the line is dropped; the job's id is the caller's to fill in. */
struct shared_facts;
bool shared_get_facts(const struct shared *s, uint32_t frame, uint32_t line,
                      const struct shared_facts **at, struct msg_facts *m);
/* Have the facts pixels of the line's base line, and are no estimate's? */
bool shared_of_base(const struct shared *s, const struct msg_facts *m);
void shared_drop_facts(struct shared *s, uint32_t frame, uint32_t line);

/* --- base lines --- */

bool shared_base_fits(const struct shared *s, const struct msg_base_line *m);

/* Put a piece to those that are there; one that leaves a gap is ignored.  True:
 * the line is whole now, and was not before. */
bool shared_put_base(struct shared *s, const struct msg_base_line *m,
                     uint64_t now_ms);

/* The piece from column *x and density *first on, which then stand behind it
 * (shelf.h); false: there is nothing more.  Valid until the line is dropped. */
bool shared_get_base(const struct shared *s, uint32_t frame, uint32_t line,
                     uint32_t *x, uint32_t *first, struct msg_base_line *m);

/* How many densities a base line of the frame leaves; and those of one that is
 * whole (NULL: it is not), or its pixels. */
uint32_t shared_ndensity(const struct shared *s, uint32_t frame);
const uint8_t *shared_densities(const struct shared *s, uint32_t frame,
                                uint32_t line);
const uint8_t *shared_pixels(const struct shared *s, uint32_t frame,
                             uint32_t line);

/* Since when it is whole; 0: it is not. */
uint64_t shared_whole_ms(const struct shared *s, uint32_t frame, uint32_t line);
void shared_drop_base(struct shared *s, uint32_t frame, uint32_t line);

/* Drop all of a frame. */
void shared_drop_frame(struct shared *s, uint32_t frame);

#endif
