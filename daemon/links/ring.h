/* ring.h - which workers are linked, in a job of very many workers
 *
 * The coordinator's part; spread.h is the workers'.  With --ambient=live up to
 * 64 workers are all linked with each other, and a record goes from its maker
 * to each.  In a job of more, workers that can be dialled get the n places of a
 * ring.  Each place has links to the places b r^k further on, for each digit 0
 * < b < r of each power of the radix r.  Such a link carries records that were
 * made less than r^k places back, unless they would go round to their maker. So
 * the digits of the distance between two places, low digits first, are the only
 * way from one place to the other: at most log n links.  Each worker has (r -
 * 1) log n links to others, and as many from others. Places change from time to
 * time, all at once.  A newcomer is until then the guest of a worker on the
 * ring, its host, which passes on the guest's records, and sends it the records
 * of the job; a worker that can have no place stays a guest.  Base lines go
 * directly: two workers are linked when one comes to need a base line of the
 * other, up to a number of such links; without a link base lines go by way of
 * the coordinator. Thread: one. */
#ifndef DAEMON_RING_H
#define DAEMON_RING_H

#include "desk/desk.h"

/* Has the job, or had it before, too many workers to link each with each? */
bool ring_wanted(const struct coord *c, const struct job *job);

/* A worker of such a job became ready; a worker of any job is gone. */
void ring_join(struct coord *c, struct job *job, uint32_t index);
void ring_left(struct coord *c, struct job *job, uint32_t index);

/* Link two workers for base lines, if the job has a ring. */
void ring_need(struct coord *c, struct job *job, uint32_t a, uint32_t b);

/* A worker reports that it has no link to another.  After two reports in a row
 * the ring does without the link, until one of the two workers connects anew.
 */
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
