/* cluster.h - a coordinator, hosts and the network between them, in virtual
 * time
 *
 * The coordinator is the real one (daemon/front/coord.c), and so are the hosts'
 * radds (daemon/worker/worker.c), the machine of strict units in a job's child
 * (daemon/strict/strict.c) and its team, which runs in a fibre
 * (tests/sim/task.h).  Played are: time, links, the disk, pixels, which cost
 * what the map says, and tiles.  Messages go through the real codec, so that
 * their bytes count.
 * A run is a function of its spec.
 * Thread: one. */
#ifndef SIM_CLUSTER_H
#define SIM_CLUSTER_H

#include "front/coord.h"
#include "tests/sim/event.h"
#include "map.h"
#include "tiles.h"

struct cluster_spec {
    const struct map *map;     /* of the picture */
    const struct tiles *tiles; /* of the passes before it; NULL: none */
    int hosts;
    int threads;       /* of each host */
    double uneven;     /* the fastest host's speed over the slowest's; speeds
                        * lie evenly between, and their mean is 1 */
    double slow;       /* the last host is so many times slower still; speeds
                        * are those of each of a host's threads */
    double latency_us; /* one way */
    double bandwidth;  /* bytes a second of each link, and the coordinator's
                        * for all together each way */
    double coord_us;   /* that the coordinator needs for a message */
    double disk_us;    /* until rows are kept */
    double load_us;    /* of the scene */
    double insert_us;  /* of a record of a closed pass into the cache */
    double growth;     /* more work, as a part, with each doubling of hosts:
                        * ambient records that are made more than once */
    double failures;   /* of each host, in an hour */
    double back_us;    /* until a host that failed is there again */
    enum msg_partition partition;
    enum msg_order order;
    uint32_t windows;
    const char *estimate; /* "uniform", "20a"; "optimum": the map's costs */
    uint32_t flags;       /* MSG_JOB_... */
    uint64_t seed;
    bool verbose;
};

/* What a host's thread does, or does not. */
enum host_state {
    HOST_LOADS,   /* the scene, or it has not heard of the job */
    HOST_TRUTH,   /* traces under a true top, or windows */
    HOST_AHEAD,   /* traces ahead */
    HOST_WAITS,   /* has nothing but units that wait for a base line */
    HOST_BELOW,   /* waits for another thread, on the line above */
    HOST_EMPTY,   /* has no unit */
    HOST_TILES,   /* makes tiles */
    HOST_WALKS,   /* finds the paths of a pass */
    HOST_INSERTS, /* puts records of a closed pass into its cache */
    HOST_CHANGES, /* waits while the cache changes, or is about to */
    HOST_BARRIER, /* has no tile, and others are at theirs */
    HOST_RECORDS, /* waits for the records of a pass that is closed */
    HOST_STATES
};

/* Slices of a run, each so much of what is ideal: 5 %. */
enum { CLUSTER_SLICES = 60, CLUSTER_SLICES_IDEAL = 20 };

struct cluster_result {
    bool done;
    char text[MSG_MAX_TEXT + 1]; /* why not */
    double seconds;              /* from submitting the job to its end */
    double busy_s;               /* of all threads, tracing */
    double wait_s;               /* the longest that a host's threads had
                                  * nothing but to wait for base lines, in the
                                  * mean */
    uint64_t traced;             /* pixels of lines; half of them are wanted */
    int threads;                 /* of all hosts, */
    double speed;                /* and of all these */
    double work;                 /* seconds of one host of speed 1 */
    double coord_s; /* processor time that coord.c really took here */
    double twice_s; /* of tiles that were made twice, or stopped */
    double passes_s; /* until all were closed */
    /* TILE_RECORDS of the coordinator and of hosts; FROZEN; TILE_MADE */
    uint64_t records_bytes, peer_bytes, frozen_bytes, tile_bytes;
    uint64_t bytes, messages, base_line_bytes, units, failed;
    double state_s[CLUSTER_SLICES][HOST_STATES]; /* of all threads */
};

/* Run it; RAD_EUSAGE for what the coordinator refuses, said in text as well. */
void cluster_run(const struct cluster_spec *spec, struct cluster_result *out);

/* --- for hosts --- */

struct host;

struct cluster {
    const struct cluster_spec *spec;
    struct cluster_result *out;
    struct events events;
    uint64_t now_us;
    struct coord *coord;
    struct host *hosts;
    struct cluster_link {
        uint64_t conn; /* the coordinator's number of it; 0: it is not there */
        /* when what was sent last is through: to the coordinator, from it, to
         * other hosts */
        uint64_t up_us, down_us, peer_us;
    } * link; /* by host */
    uint8_t job[MSG_JOB];
    uint64_t sequence; /* of the job, as the coordinator numbers it */
    uint64_t next_conn, client;
    uint64_t coord_in_us, coord_busy_us, coord_out_us, disk_us, start_us,
        random;
    bool over;
    uint32_t passes;                     /* that are closed */
    uint64_t closed_us[RAD_MOST_PASSES]; /* when it was; 0: it is open */
    uint32_t nrecords[RAD_MOST_PASSES];  /* that it has then */
    uint8_t *made[RAD_MOST_PASSES];      /* which tiles are */
    struct msg msg;
};

/* A host's new connection to the coordinator. */
void cluster_open(struct cluster *c, int host);

/* A message from a host to the coordinator; to another host, where *e is what
 * happens when it is there. */
void cluster_send(struct cluster *c, int host, const uint8_t *bytes,
                  size_t len);
void cluster_send_peer(struct cluster *c, int host, const struct event *e,
                       const uint8_t *bytes, size_t len);

/* The message in a frame, until the next call. */
const struct msg *cluster_decode(struct cluster *c, const uint8_t *bytes,
                                 size_t len);

/* Milliseconds, for the machines. */
uint64_t cluster_ms(const struct cluster *c);

/* Is it the first to have made the tile? */
bool cluster_first(struct cluster *c, uint32_t pass, uint32_t tile);

/* Uniform in [0, 1), the next of the run's; n random bytes. */
double cluster_random(struct cluster *c);
void cluster_bytes(void *cluster, void *buf, size_t n);

#endif
