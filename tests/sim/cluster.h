/* cluster.h - a whole cluster in one process, in virtual time
 *
 * The real coordinator and the real workers, with their actions carried out by
 * net.c; children, clients and disks are played here.  A pixel's value says
 * where it is and which attempt made it, so that the picture tells whether
 * each came once and from the attempt that counts. */
#ifndef SIM_CLUSTER_H
#define SIM_CLUSTER_H

#include "coord.h"
#include "net.h"
#include "worker.h"

enum {
    SIM_WORKERS = 6,
    SIM_JOBS = 3,
    SIM_FILES = 3, /* of a job */
    SIM_FRAMES = 3,
    SIM_CHILDREN = 40,
    SIM_PSAMPLE = 4, /* -ps, the default */
    /* nodes */
    NODE_COORD = 0,
    NODE_WORKER = 1,
    NODE_CLIENT = NODE_WORKER + SIM_WORKERS,
    NODE_CHILD = 16
};

struct sim_pixel {
    float x, y, attempt;
};

struct sim_job {
    uint8_t id[MSG_JOB];
    struct msg_spec spec;
    uint8_t hash[SIM_FILES * MSG_HASH];
    struct msg_frame frame[SIM_FRAMES];
    struct sim_pixel *picture[SIM_FRAMES];
    bool written[SIM_FRAMES];
    uint32_t poison;  /* a unit that kills children; UINT32_MAX: none */
    bool cancel;      /* the client changes its mind */
    bool vanish;      /* the client goes away for a while */
    unsigned crashes; /* of its children so far */
    /* its client */
    uint64_t conn;
    bool accepted, done, failed;
    uint16_t status;
    char text[MSG_MAX_TEXT + 1];
    char *stats; /* JSON, in the end */
    size_t stats_len;
};

/* A strict unit goes the way of a real one: some time ahead, then, when the
 * base line above is there, its own base line and its rows. */
struct sim_unit {
    struct msg_unit unit;
    bool running, ahead, parked;
};

enum { SIM_SIDE = 40, SIM_LINES = 16 };

/* Columns and densities of a base line that a child has. */
struct sim_line {
    uint8_t pixel[SIM_SIDE], density[SIM_SIDE];
};

struct sim_child {
    int worker; /* index */
    uint64_t conn;
    int job;
    bool started;
    struct sim_unit queue[512];
    unsigned nqueue, running;
    struct sim_line line[SIM_FRAMES][SIM_LINES];
    double busy_s;
    unsigned nambient;
};

struct sim_worker {
    struct worker *machine; /* NULL: dead */
    unsigned life, threads, random;
    char name[16], address[16];
    bool cache[SIM_JOBS * SIM_FILES];
    uint64_t given_up; /* dial that it does not want any more */
};

struct sim {
    struct net net; /* first: events and ops find the rest from it */
    struct coord *coord;
    bool store[SIM_JOBS * SIM_FILES];
    struct sim_worker worker[SIM_WORKERS];
    int nworkers;
    struct sim_job job[SIM_JOBS];
    int njobs;
    struct sim_child child[SIM_CHILDREN];
    uint64_t disk_ms; /* the coordinator's disk is busy until then */
    bool calm;        /* no more accidents */
    unsigned deaths, cuts, crashes;
    unsigned parked, gave, twins, estimates; /* what was tried at all */
};

/* Set a cluster up as the seed says, let it live until every job is over and
 * it came to rest. */
void sim_init(struct sim *s, uint64_t seed);
void sim_run(struct sim *s);
void sim_release(struct sim *s);

/* The shells' part: carry out what a machine wants. */
void sim_coord_actions(struct sim *s);
void sim_worker_actions(struct sim *s, int worker);

/* Children (child.c). */
extern const struct node_ops sim_child_ops;
void sim_spawn(struct sim *s, int worker, uint64_t conn);
void sim_kill(struct sim *s, int worker, uint64_t conn);

/* Clients (client.c). */
extern const struct node_ops sim_client_ops;
void sim_client_dial(struct sim *s, int job);

int sim_find_job(const struct sim *s, const uint8_t id[MSG_JOB]);
/* Index of a file of ours by its hash. */
int sim_file(const uint8_t hash[MSG_HASH]);

#endif
