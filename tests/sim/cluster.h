/* cluster.h - a whole cluster in one process, in virtual time
 *
 * The coordinator and the workers are the real machines; net.c carries their
 * messages, and cluster.c their other actions.  Clients and disks are played.
 * A job's child has the real machine of strict units and the real sampler, on
 * pictures by formula; its passes have one member each and run in slices of
 * virtual time.  So whole pictures, and the rays that they took, can be
 * compared with those of one sampler alone. */
#ifndef SIM_CLUSTER_H
#define SIM_CLUSTER_H

#include "front/coord.h"
#include "net.h"
#include "passes/passplan.h"
#include "picture/quincunx.h"
#include "worker/worker.h"

enum {
    SIM_WORKERS = 16,
    SIM_JOBS = 3,
    SIM_FILES = 3, /* of a job */
    SIM_FRAMES = 3,
    SIM_CHILDREN = 96,
    SIM_THREADS = 4,
    SIM_WIDTH = 100, /* most columns of a frame, at least */
    SIM_HEIGHT = 2100,
    SIM_TALL = 200,
    SIM_EDGES = 4,
    SIM_TYPES = 128,  /* of messages */
    SIM_UNITS = 4096, /* most units of a job */
    /* numbers of nodes */
    NODE_COORD = 0,
    NODE_WORKER = 1,
    NODE_CLIENT = NODE_WORKER + SIM_WORKERS,
    NODE_ADMIN = NODE_CLIENT + SIM_JOBS,
    NODE_CHILD = NODE_ADMIN + 1
};
_Static_assert(NODE_CHILD + SIM_CHILDREN <= NET_NODES, "too many nodes");

/* The picture of a frame: a disc and edges. */
struct sim_look {
    double disc_u, disc_v, disc; /* centre; square of the radius */
    double edge[SIM_EDGES][3];
};

/* A unit on the coordinator's disk, and the other data of a job there. */
struct sim_unit {
    bool there;
    struct saved_unit saved;
    char worker[16];
    uint8_t *bottom;
};

struct sim_kept {
    bool opened;
    unsigned lives; /* lives of the coordinator that ended since */
    struct saved_job job;
    char text[MSG_MAX_TEXT + 1];
    char *stats; /* of a job that is over */
    bool cached; /* it is done, and its passes are kept for others */
    uint32_t npasses;
    struct pass_range keep;
    struct saved_pass pass[MSG_MOST_PASSES]; /* bytes are malloc'd */
    uint32_t nunits;
    struct sim_unit unit[SIM_UNITS];
};

struct sim_job {
    struct sim_kept kept;
    uint8_t id[MSG_JOB];
    struct msg_spec spec;
    uint8_t hash[SIM_FILES * MSG_HASH];
    struct msg_frame frame[SIM_FRAMES];
    struct sim_look looks[SIM_FRAMES];
    uint64_t look;
    int psample;
    double maxdiff;
    bool round; /* the view shows nothing in two corners */
    bool paint;
    unsigned pixel_us; /* least time of a pixel */
    char params[RAD_PARAMS_TEXT];
    int bounces;                   /* -ab */
    char options[RAD_PARAMS_TEXT]; /* for its pictures, as the store was told in
                                    * this life of the coordinator; or "" */
    uint8_t costs[4 * SIM_FRAMES * SIM_HEIGHT];
    struct rad_pixel *picture[SIM_FRAMES]; /* rows that were stored */
    uint8_t *line[SIM_FRAMES];             /* base lines, for coded rows */
    struct rad_pixel *want[SIM_FRAMES];    /* as one sampler alone makes it */
    struct saved_frame frames[SIM_FRAMES];
    bool poisoned;         /* a pixel of frame 0 kills children */
    int poison_y;          /* its row; it is in column 0 */
    uint64_t traced;       /* rays of pixels, by all children */
    uint64_t tile_rays;    /* rays of tiles, by all children */
    bool watched;          /* its client asks for previews */
    bool reuses;           /* it asks for another job's cache */
    uint8_t from[MSG_JOB]; /* that job, if spec.flags say so */
    bool cancel;           /* the client cancels the job */
    bool vanish;           /* the client goes away for a while */
    unsigned crashes;      /* of its children, by accident, so far */
    /* the client's: */
    uint64_t conn;
    bool accepted, done, failed;
    uint16_t status;
    char text[MSG_MAX_TEXT + 1];
    char *stats; /* JSON, once the job is over */
    size_t stats_len;
    bool partial; /* stats are not whole yet */
};

struct sim_task; /* what a thread of a child works on (child.c) */

struct sim_child {
    int worker; /* index */
    uint64_t conn;
    int job;
    bool started;
    bool coded;     /* rows are sent coded */
    uint32_t frame; /* frame of the last unit */
    struct strict *strict;
    struct sim_task *task[SIM_THREADS]; /* an idle thread's is NULL */
    struct msg_unit windows[512];       /* windows that wait */
    unsigned nwindows;
    uint64_t tick_ms; /* when to tell the machine the time; 0: not */
    double busy_s;
    unsigned nambient;
    uint32_t passes;   /* passes whose records it has */
    uint32_t stage;    /* the first pass of its stage */
    uint32_t nrecords; /* of the next pass, so far */
    bool shown;        /* it was told the pictures' options (SHOW) */
};

struct sim_worker {
    struct worker *machine; /* NULL: the worker is dead */
    unsigned life, threads, random;
    unsigned slow;       /* this many times slower than others */
    uint64_t stopped_ms; /* its children stand still until then */
    bool draining;
    char name[16], address[16];
    bool drained; /* as the coordinator's disk says */
    bool cache[SIM_JOBS * SIM_FILES];
    uint64_t given_up; /* a dial that it has closed meanwhile */
    struct sim *sim;
};

/* An accident when the n-th message of a type is heard. */
struct sim_fault {
    enum msg_type type;
    unsigned n; /* messages until then; 0: it has happened */
    enum sim_victim { SIM_GIVER, SIM_RECEIVER, SIM_THIRD } victim;
    enum sim_blow {
        SIM_WORKER_DIES,
        SIM_CHILD_DIES,
        SIM_PEERS_CUT,
        SIM_COORD_CUT,
        SIM_COORD_DIES,
        SIM_NBLOW
    } blow;
    bool after; /* it happens after the message was heard, not before */
};

enum { SIM_FAULTS = 3 };

struct sim {
    struct net net;  /* first, so that struct sim is found from it */
    uint64_t digest; /* of all actions; see digest_action() */
    struct coord *coord;
    bool store[SIM_JOBS * SIM_FILES];
    struct sim_worker worker[SIM_WORKERS];
    int nworkers;
    struct sim_job job[SIM_JOBS];
    int njobs;
    struct sim_child child[SIM_CHILDREN];
    unsigned direct;             /* as in coord_env */
    bool keeps;                  /* the disk outlives the coordinator */
    unsigned lives;              /* lives of the coordinator */
    uint64_t disk_ms;            /* the disk's queue is done by then */
    bool calm;                   /* accidents have ended */
    unsigned accidents;          /* one in so many ticks; 0: none */
    unsigned orders;             /* of users and administrators; likewise */
    struct sim_fault fault[SIM_FAULTS];
    uint64_t admin; /* its connection */
    bool admin_welcome;
    double work_ms; /* of all children's threads */
    /* counts of what happened: */
    unsigned coord_deaths;
    unsigned deaths, cuts, peer_cuts, crashes, drains, stops, repeats;
    unsigned refused; /* jobs that workers had no room for */
    unsigned parted;
    unsigned pauses, priorities, rests;
    unsigned yields; /* units that were told to go back */
    unsigned late;   /* units that got a twin for being late */
    unsigned blows[SIM_TYPES][SIM_NBLOW];
    unsigned tiles, passes, stages; /* made; closed, begun at a child */
    unsigned colours;               /* tiles that told colours */
    unsigned reused;                /* first passes of other jobs' caches */
    unsigned parked, gave, loans, blocked, estimates;
    unsigned
        aside; /* passes that made way for others' bottoms while making rows */
};

/* The cluster that the network is a part of. */
static inline struct sim *
sim_of(struct net *net)
{
    return (struct sim *)net;
}

/* The child at a node from NODE_CHILD on. */
static inline struct sim_child *
sim_child_of(struct net *net, int node)
{
    return &sim_of(net)->child[node - NODE_CHILD];
}

/* Make the cluster of a seed; run it until each job is over and all workers
 * have dropped it. */
void sim_init(struct sim *s, uint64_t seed);
void sim_run(struct sim *s);
void sim_release(struct sim *s);

/* Carry out the actions of a machine, as the shells do. */
void sim_coord_actions(struct sim *s);
void sim_worker_actions(struct sim *s, int worker);

/* Pictures (picture.c). */
void sim_make_pictures(struct net *net, struct sim_job *job);
bool sim_pixel(const struct sim_job *job, uint32_t frame, int x, int y,
               struct rad_pixel *out);
/* Paint columns x0 to x1-1 of a row; row[0] is column x0. */
void sim_paint(const struct sim_job *job, uint32_t frame, int x0, int x1, int y,
               struct rad_pixel *row);
unsigned sim_pixel_us(const struct sim_job *job, uint32_t frame, int x, int y);
struct rad_quincunx sim_sampler(const struct sim_job *job, uint32_t frame);
/* Sample a part of a frame by itself into the picture; returns its primary
 * rays. */
uint64_t sim_alone(const struct sim_job *job, uint32_t frame, int x, int y,
                   int width, int height, struct rad_pixel *picture);
/* A row of frame 0 whose first pixel is traced, whoever traces it; not for
 * windows. */
int sim_any_traced(struct net *net, const struct sim_job *job);

/* Accidents (fault.c). */
void sim_make_faults(struct sim *s);
/* Let an accident happen, perhaps. */
void sim_accident(struct sim *s);
/* Give an order about a job or a worker. */
void sim_order(struct sim *s);
/* Accidents at messages: the hear() of struct net (net.h). */
void sim_hear(struct net *net, int from, int to, const struct msg *m,
              bool after);
/* The worker ends, and comes to life again later. */
void sim_worker_dies(struct sim *s, int worker);
/* Cut the worker's connection to the coordinator. */
void sim_coord_cut(struct sim *s, int worker);

/* The coordinator's disk and lives (disk.c). */
void sim_disk(struct sim *s, const struct action *a, int job);
void sim_coord_born(struct sim *s);
void sim_coord_dies(struct sim *s);
void sim_disk_release(struct sim_job *job);

/* Children (child.c). */
extern const struct node_ops sim_child_ops;
void sim_spawn(struct sim *s, int worker, uint64_t conn);
void sim_kill(struct sim *s, int worker, uint64_t conn);
/* Let the child crash by accident, unless one of its job has done so before. */
void sim_crash(struct sim *s, int child);
void sim_children_release(struct sim *s);

/* Passes (tiles.c). */
void sim_check_colours(struct net *net, const struct sim_job *job,
                       const struct action_colours *k);
void sim_take_tile(struct net *net, int node, const struct msg_tile *m);
void sim_take_frozen(struct net *net, int node, const struct msg_frozen *m);
void sim_take_stage(struct net *net, int node, const struct msg_stage *m);
void sim_take_show(struct net *net, int node, const struct msg_stage *m);
/* A picture is to be written: was the store told the right options? */
void sim_check_options(struct net *net, const struct sim_job *job);
/* Does the child's cache have the records for the frame, and no others? */
bool sim_cache_serves(const struct sim *s, const struct sim_child *k,
                      uint32_t frame);

/* Clients (client.c). */
extern const struct node_ops sim_client_ops;
void sim_client_dial(struct sim *s, int job);
extern const struct node_ops sim_admin_ops;
void sim_admin_dial(struct sim *s);
/* Give an order about worker or job i. */
void sim_admin_say(struct sim *s, enum msg_type type, int i);
/* Take back all orders that hold up workers or jobs. */
void sim_admin_relent(struct sim *s);

int sim_find_job(const struct sim *s, const uint8_t id[MSG_JOB]);
/* The index of a file, by its hash. */
int sim_file(const uint8_t hash[MSG_HASH]);

#endif
