/* host_impl.h - a simulated host, and what its files ask of each other
 *
 * Private to host*.c:
 *   host.c           the child's messages, what comes next, its life
 *   host_radd.c      the radd that the child belongs to
 *   host_time.c      what it does when, and in all
 *   host_pass.c      passes of strict units
 *   host_tiles.c     tiles of the ambient cache
 *   host_errand.c    windows and estimates
 *   host_rows.c      rows to the coordinator
 * Seconds of work are virtual ones of this host. */
#ifndef SIM_HOST_IMPL_H
#define SIM_HOST_IMPL_H

#include "host.h"

#include "tests/sim/task.h"

#include <uv.h>

/* The office at night makes so many rays in a second on one processor. */
#define RAYS_PER_S 1.7e6

/* More tiles for each thread the coordinator does not give. */
#define HOST_MOST_TILES 16

struct host_thread {
    struct host *host;
    bool working;  /* until an event */
    unsigned step; /* counts what it did: older events are void */
    enum host_state state;
    uint64_t state_us;        /* since when */
    enum host_state at_tiles; /* for tiles; HOST_STATES: nothing */
    struct host_tile {
        uint32_t pass, tile;
    } tile;                   /* that it makes, or begins the pass of */
    struct errand *errand;    /* that it does */
    struct host_pass *pass;   /* a team that it is in, */
    struct fibre *fibre;      /* as this member */
    double owed;              /* cost of pixels whose time is to come */
    const uv_cond_t *waits;   /* for a thread on the line above; NULL: no */
    struct host_thread *next; /* of all that wait so */
};

struct host {
    struct cluster *cluster;
    int number;
    char name[16], address[16];
    double speed;          /* of each thread */
    unsigned life;         /* its ends and its child's: older events are void */
    struct worker *radd;   /* NULL: it is dead */
    struct peer_end *ends; /* of links to other hosts */
    uint64_t own, child;   /* the radd's numbers of its connections to the
                            * coordinator and the child; 0: none */
    struct rad_quincunx *frames; /* for strict_new() */
    struct strict *strict;       /* NULL: no job */
    struct host_thread *thread;
    struct host_pass *teams; /* at work, newest first */
    bool lines;              /* it has had strict units */
    /* passes that are closed, as far as it knows, and that are in its cache */
    uint32_t closed, passes;
    struct host_tile *tile; /* to make, but for those that threads make */
    uint32_t ntiles;
    int members[MSG_OPEN_PASSES]; /* threads that make tiles, by pass modulo */
    bool changing; /* a thread gets a pass ready, or puts records in, */
    bool alone;    /* while no other makes a tile */
    uint32_t begun[MSG_OPEN_PASSES]; /* a pass that is ready for tiles, + 1 */
    struct errand *errands;          /* to do */
    bool ticking, ready;
    uint64_t idle_us; /* since then threads wait for a top, */
    int idle;         /* so many */
    /* for the result; wait_s: of all threads */
    double busy_s, wait_s, twice_s;
    uint64_t traced, units;
    uint8_t *code; /* rows of a piece, each of so many bytes, */
    size_t row_bytes;
    uint32_t code_width; /* of so many columns */
};
/* --- host.c --- */

const struct map *host_map(const struct host *h);

/* Have fn called, unless the host dies before. */
void host_later(struct host *h, double delay_us,
                void (*fn)(void *arg, struct event *e));
/* The host that an event is for; NULL: it died since. */
struct host *host_alive(void *arg, const struct event *e);
/* The thread works for so long, and then fn is called. */
void host_spend(struct host_thread *t, double seconds,
                void (*fn)(void *arg, struct event *e));
/* The thread that an event is for, which rests now; NULL: it was stopped. */
struct host_thread *host_rests(void *arg, const struct event *e);

/* A message to the child, and its end. */
void host_child_message(struct host *h, const struct msg *m);
void host_child_over(struct host *h);
/* All that strict.c has to say. */
void host_flush(struct host *h);
/* Something happened: do what there is to do now. */
void host_go_on(struct host *h);

/* What a cost takes here. */
double host_seconds(const struct host *h, double cost);
struct msg_counts host_counts(const struct host *h, double seconds,
                              double wall_s, uint64_t pixels);

/* --- host_radd.c --- */

/* The child says that. */
void host_say(struct host *h, const struct msg *m);
void host_radd_dies(struct host *h);
void host_radd_release(struct host *h);

/* --- host_time.c --- */

/* Book what all threads, or one, did until now. */
void host_time_look(struct host *h);
void host_time_note(struct host_thread *t);
/* For --verbose: what it does now, and with which lines. */
void host_time_tell(const struct host_thread *t, const char *what);
/* See whether threads wait for a base line, and count that. */
void host_time_wait(struct host *h);

/* --- host_pass.c --- */

struct host_pass;

/* Begin a pass, or join a team; false: there is none. */
bool host_pass_begin(struct host_thread *t);
/* Go on with the pass, or leave it. */
void host_pass_trace(struct host_thread *t);
/* What its members do; and for --verbose. */
enum host_state host_pass_state(const struct host_pass *p);
void host_pass_tell(const struct host_pass *p);
/* Carry out what the machine asks of passes. */
void host_pass_look(struct host *h);
void host_passes_drop(struct host *h);

/* --- host_tiles.c --- */

/* Are tiles to be made before the picture? */
bool host_tiles_open(const struct host *h);
/* False: the message is not of tiles. */
bool host_tiles_message(struct host *h, const struct msg *m);
/* Begin what is to be done for them next; false: there is nothing. */
bool host_tiles_begin(struct host_thread *t);
/* Does the cache change, or wait for that? */
bool host_tiles_change(const struct host *h);
void host_tiles_forget(struct host *h);

/* --- host_errand.c --- */

void host_errand_window(struct host *h, const struct msg_unit *u);
void host_errand_estimate(struct host *h, const struct msg_estimate *m);
/* False: there is none. */
bool host_errand_begin(struct host_thread *t);
void host_errand_revoke(struct host *h, const struct msg_attempt *r);
void host_errands_forget(struct host *h);

/* --- host_rows.c --- */

/* Room for host.code. */
size_t host_rows_room(const struct host *h);
/* How many rows of so many columns are in a piece as they travel. */
uint32_t host_rows_piece(struct host *h, uint32_t width);
/* Rows of a unit, in pieces as long as a child's.  counts: what the unit cost,
 * if they are its last rows; else NULL. */
void host_rows_send(struct host *h, const struct msg_unit *u, uint32_t row,
                    uint32_t rows, const struct msg_counts *counts);

#endif
