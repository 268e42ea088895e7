/* cluster.h - a whole cluster in one process, in virtual time
 *
 * The real coordinator and the real workers, with their actions carried out by
 * net.c; clients and disks are played here.  A job's child is the real machine
 * of strict units and the real sampler, on pictures by formula; its passes run
 * in slices of virtual time, one member each.  So whole pictures, and what they
 * took, can be held against one sampler alone. */
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
    SIM_WIDTH = 100, /* of a picture, and more */
    SIM_HEIGHT = 2100,
    SIM_TALL = 200,
    SIM_EDGES = 4,
    SIM_TYPES = 128,  /* of messages */
    SIM_UNITS = 4096, /* of a job */
    /* nodes */
    NODE_COORD = 0,
    NODE_WORKER = 1,
    NODE_CLIENT = NODE_WORKER + SIM_WORKERS,
    NODE_ADMIN = NODE_CLIENT + SIM_JOBS,
    NODE_CHILD = NODE_ADMIN + 1
};
_Static_assert(NODE_CHILD + SIM_CHILDREN <= NET_NODES, "too many nodes");

/* What is to be seen in a frame. */
struct sim_look {
    double disc_u, disc_v, disc; /* centre, square of the radius */
    double edge[SIM_EDGES][3];
};

/* What of a job is on the coordinator's disk. */
struct sim_unit {
    bool there;
    struct saved_unit saved;
    char worker[16];
    uint8_t *bottom;
};

struct sim_kept {
    bool opened;
    unsigned lives; /* that ended since */
    struct saved_job job;
    char text[MSG_MAX_TEXT + 1];
    char *stats; /* of one that is over */
    bool cached; /* the passes of one that is done, for others */
    uint32_t npasses;
    struct pass_range keep;
    struct saved_pass pass[MSG_MOST_PASSES]; /* malloc'd */
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
    unsigned pixel_us; /* what a pixel costs at least */
    char params[RAD_PARAMS_TEXT];
    int bounces;                   /* -ab */
    char options[RAD_PARAMS_TEXT]; /* of its picture, as the store was told in
                                    * this life of the coordinator; or "" */
    uint8_t costs[4 * SIM_FRAMES * SIM_HEIGHT];
    struct rad_pixel *picture[SIM_FRAMES]; /* as it comes */
    uint8_t *line[SIM_FRAMES];             /* base lines of coded rows */
    struct rad_pixel *want[SIM_FRAMES];    /* as one alone makes it */
    struct saved_frame frames[SIM_FRAMES];
    bool poisoned;         /* a pixel of frame 0 that kills children */
    int poison_y;          /* in column 0 */
    uint64_t traced;       /* by all children together */
    uint64_t tile_rays;    /* likewise, for tiles */
    bool watched;          /* its client wants previews */
    bool reuses;           /* it wants to begin with the cache of another, */
    uint8_t from[MSG_JOB]; /* with this one's, where spec.flags say so */
    bool cancel;           /* the client changes its mind */
    bool vanish;           /* the client goes away for a while */
    unsigned crashes;      /* of its children so far */
    /* its client */
    uint64_t conn;
    bool accepted, done, failed;
    uint16_t status;
    char text[MSG_MAX_TEXT + 1];
    char *stats; /* JSON, in the end */
    size_t stats_len;
    bool partial; /* there is more to come of it */
};

struct sim_task; /* a thread of a child at work (child.c) */

struct sim_child {
    int worker; /* index */
    uint64_t conn;
    int job;
    bool started;
    bool coded;     /* rows leave so */
    uint32_t frame; /* of the last unit */
    struct strict *strict;
    struct sim_task *task[SIM_THREADS]; /* NULL: the thread is idle */
    struct msg_unit windows[512];       /* that wait */
    unsigned nwindows;
    uint64_t tick_ms; /* the machine is to be told the time; 0: is not */
    double busy_s;
    int rests; /* REST came so often */
    unsigned nambient;
    uint32_t passes;   /* whose records it has */
    uint32_t stage;    /* the first pass of the stage that it is at */
    uint32_t nrecords; /* of the next, so far */
    bool shown;        /* it knows how pictures are made over them */
};

struct sim_worker {
    struct worker *machine; /* NULL: dead */
    unsigned life, threads, random;
    unsigned slow;       /* so many times */
    uint64_t stopped_ms; /* its children stand still until then */
    bool draining;
    char name[16], address[16];
    bool drained; /* on the coordinator's disk */
    bool cache[SIM_JOBS * SIM_FILES];
    uint64_t given_up; /* dial that it does not want any more */
    struct sim *sim;
};

/* An accident at the n-th message of a type. */
struct sim_fault {
    enum msg_type type;
    unsigned n; /* messages until then; 0: it is over */
    enum sim_victim { SIM_GIVER, SIM_RECEIVER, SIM_THIRD } victim;
    enum sim_blow {
        SIM_WORKER_DIES,
        SIM_CHILD_DIES,
        SIM_PEERS_CUT,
        SIM_COORD_CUT,
        SIM_COORD_DIES,
        SIM_NBLOW
    } blow;
    bool after; /* the message is heard yet */
};

enum { SIM_FAULTS = 3 };

struct sim {
    struct net net;  /* first: events and ops find the rest from it */
    uint64_t digest; /* of all actions, see digest_action() */
    struct coord *coord;
    bool store[SIM_JOBS * SIM_FILES];
    struct sim_worker worker[SIM_WORKERS];
    int nworkers;
    struct sim_job job[SIM_JOBS];
    int njobs;
    struct sim_child child[SIM_CHILDREN];
    unsigned all_linked, direct; /* as in coord_env */
    bool keeps;         /* what is on the disk outlives the coordinator */
    unsigned lives;     /* of the coordinator, this one too */
    uint64_t disk_ms;   /* the coordinator's disk is busy until then */
    bool calm;          /* no more accidents */
    unsigned accidents; /* one in so many ticks; 0: none */
    unsigned orders;    /* of users and admins; likewise */
    struct sim_fault fault[SIM_FAULTS];
    uint64_t admin; /* its connection */
    bool admin_welcome;
    double work_ms; /* of all children's threads together */
    /* what happened at all */
    unsigned coord_deaths;
    unsigned deaths, cuts, peer_cuts, crashes, drains, stops, repeats;
    unsigned refused; /* jobs, by workers without room */
    unsigned parted;
    unsigned pauses, priorities, rests;
    unsigned yields; /* units that were to go back, all or in part */
    unsigned late;   /* units that others got as well */
    unsigned blows[SIM_TYPES][SIM_NBLOW];
    unsigned tiles, passes, stages; /* made; closed, begun at a child */
    unsigned colours;               /* tiles that told theirs */
    unsigned reused; /* first passes with records of other jobs */
    unsigned parked, gave, twins, loans, blocked, estimates;
    unsigned estimates_left; /* of these, before their end */
    unsigned bars; /* units whose bars come along with their base lines */
    unsigned
        aside; /* TRUTH that made way for others' bottoms, rows being out */
};

/* That the network is part of. */
static inline struct sim *
sim_of(struct net *net)
{
    return (struct sim *)net;
}

/* At a node from NODE_CHILD on. */
static inline struct sim_child *
sim_child_of(struct net *net, int node)
{
    return &sim_of(net)->child[node - NODE_CHILD];
}

/* Set a cluster up as the seed says, let it live until every job is over and
 * it came to rest. */
void sim_init(struct sim *s, uint64_t seed);
void sim_run(struct sim *s);
void sim_release(struct sim *s);

/* The shells' part: carry out what a machine wants. */
void sim_coord_actions(struct sim *s);
void sim_worker_actions(struct sim *s, int worker);

/* Pictures (picture.c). */
void sim_make_pictures(struct net *net, struct sim_job *job);
bool sim_pixel(const struct sim_job *job, uint32_t frame, int x, int y,
               struct rad_pixel *out);
/* Columns x0 to x1-1 of a row; row[0] is column x0. */
void sim_paint(const struct sim_job *job, uint32_t frame, int x0, int x1, int y,
               struct rad_pixel *row);
unsigned sim_pixel_us(const struct sim_job *job, uint32_t frame, int x, int y);
struct rad_quincunx sim_sampler(const struct sim_job *job, uint32_t frame);
/* Sample that part of a frame by itself into the picture; primary rays. */
uint64_t sim_alone(const struct sim_job *job, uint32_t frame, int x, int y,
                   int width, int height, struct rad_pixel *picture);
/* A row of frame 0 whose first pixel is traced, if it is no window's. */
int sim_any_traced(struct net *net, const struct sim_job *job);

/* Accidents (fault.c). */
void sim_make_faults(struct sim *s);
/* Something may happen now. */
void sim_accident(struct sim *s);
/* Somebody steers jobs, or workers. */
void sim_order(struct sim *s);
/* Accidents at messages; see net.h. */
void sim_hear(struct net *net, int from, int to, const struct msg *m,
              bool after);
/* The worker comes to an end, and back to life later. */
void sim_worker_dies(struct sim *s, int worker);
/* The connection is cut at this side. */
void sim_coord_cut(struct sim *s, int worker);

/* The coordinator's disk, and its lives (disk.c). */
void sim_disk(struct sim *s, const struct action *a, int job);
void sim_coord_born(struct sim *s);
void sim_coord_dies(struct sim *s);
void sim_disk_release(struct sim_job *job);

/* Children (child.c). */
extern const struct node_ops sim_child_ops;
void sim_spawn(struct sim *s, int worker, uint64_t conn);
void sim_kill(struct sim *s, int worker, uint64_t conn);
/* It crashes, if one of its job may do so by accident. */
void sim_crash(struct sim *s, int child);
void sim_children_release(struct sim *s);

/* Passes (tiles.c). */
void sim_check_colours(struct net *net, const struct sim_job *job,
                       const struct action_colours *k);
void sim_take_tile(struct net *net, int node, const struct msg_tile *m);
void sim_take_frozen(struct net *net, int node, const struct msg_frozen *m);
void sim_take_stage(struct net *net, int node, const struct msg_stage *m);
void sim_take_show(struct net *net, int node, const struct msg_stage *m);
/* The picture is to be written: was the store told with which options? */
void sim_check_options(struct net *net, const struct sim_job *job);
/* Has its cache the records that the frame is made with, and no others? */
bool sim_cache_serves(const struct sim *s, const struct sim_child *k,
                      uint32_t frame);

/* Clients (client.c). */
extern const struct node_ops sim_client_ops;
void sim_client_dial(struct sim *s, int job);
extern const struct node_ops sim_admin_ops;
void sim_admin_dial(struct sim *s);
/* About a worker, or a job. */
void sim_admin_say(struct sim *s, enum msg_type type, int i);
/* Nothing that was ordered holds anybody back any more. */
void sim_admin_relent(struct sim *s);

int sim_find_job(const struct sim *s, const uint8_t id[MSG_JOB]);
/* Index of a file of ours by its hash. */
int sim_file(const uint8_t hash[MSG_HASH]);

#endif
