/* ring.h - who is linked with whom in a job of very many workers
 *
 * The coordinator's part; spread.h is the workers'.  Up to 64 workers all are
 * linked with all, and what one makes goes to each.  For more, those that can
 * be dialled get a place on a ring of n: a link goes from each to the places b
 * r^k further on, for each digit b < r of each power of the radix r.  Records
 * that were made less than r^k places back go over such a link, if they do not
 * get around to their maker.  The digits of the distance between two places,
 * the low ones first, are then the one way from one to the other: at most log
 * n links, and each worker has (r - 1) log n of its own, and as many that
 * others have with it.
 * Places change only from time to time, and all at once: meanwhile a newcomer
 * has one on the ring that speaks for it, which also gives it what there is;
 * and so have, for good, those that can have no place.  Base lines go directly:
 * for them two workers are linked when they come to need it, up to a number of
 * such links, and without one they come by the coordinator.
 * Thread: one. */
#ifndef DAEMON_RING_H
#define DAEMON_RING_H

#include "desk/desk.h"

/* Has the job, or had it, too many workers to be linked all with all? */
bool ring_wanted(const struct coord *c, const struct job *job);

/* A worker of such a job became ready; a worker of any job is gone. */
void ring_join(struct coord *c, struct job *job, uint32_t index);
void ring_left(struct coord *c, struct job *job, uint32_t index);

/* A worker of a job of few, which are linked all with all, became ready or is
 * gone: they get places too, for records that are not urgent, if all can have
 * one. */
void ring_of_few(struct coord *c, struct job *job);

/* Link two workers for base lines, if the job has a ring. */
void ring_need(struct coord *c, struct job *job, uint32_t a, uint32_t b);

/* A worker says that it has no link to another.  A link that is missing twice
 * in a row is hopeless, until one of the two workers comes anew: nothing relies
 * on it any more.  In a ring of few it is tried again from time to time. */
void ring_unlinked(struct coord *c, struct job *job, uint32_t index,
                   const struct msg_unlinked *m);

/* Give places anew, if workers came or went. */
void ring_tick(struct coord *c, struct job *job);

/* NULL is accepted. */
void ring_free(struct ring *r);

/* The links of a place on a ring: the i-th leads *offset places on, for records
 * that come from fewer than *below places back; false: there is no i-th. */
bool ring_link(uint32_t places, uint32_t i, uint32_t *offset, uint32_t *below);

#endif
