/* message.h - what coordinator, workers, users and children say to each other
 *
 * One struct per message, all in the tagged struct msg.  message.def lists
 * them with their numbers, limits and where each may arrive; doc/protocol.md
 * has their bytes.
 *
 * A message that was unpacked borrows: its strings and byte ranges point into
 * the payload, its list (frames, peers, units) into msg.list.  Both are valid
 * until the payload goes or the same struct msg is unpacked into again.
 * Strings are never NULL, always terminated and UTF-8.
 * Thread: a struct msg belongs to one thread. */
#ifndef MESSAGE_H
#define MESSAGE_H

#include "base/error.h"
#include "proto/wire.h"

/* Versions of the protocol: the current one, and the oldest that is spoken
 * besides.  A struct msg is always of the current one; what the other side of a
 * connection speaks matters only where bytes are made and read. */
#define MSG_VERSION     2
#define MSG_VERSION_MIN 1

#define MSG_MAX         (1u << 20) /* largest payload [bytes] */
#define MSG_MAX_CHUNK   (1u << 18) /* most file bytes in a CHUNK */
#define MSG_MAX_AMBIENT (1u << 17) /* most record bytes in an AMBIENT */
#define MSG_MAX_SPREAD  (MSG_MAX_AMBIENT + (1u << 16)) /* a whole SPREAD */
#define MSG_MAX_PARTS   4096
#define MSG_MAX_PLACES  65536           /* on a ring */
#define MSG_MAX_PIXELS  (MSG_MAX - 256) /* most pixel bytes in a RESULT */

/* String limits [bytes, without the NUL]. */
#define MSG_MAX_NAME    64
#define MSG_MAX_LABEL   4096 /* what a user calls a job: a path may be one */
#define MSG_MAX_KEY     96
#define MSG_MAX_ADDRESS 200
#define MSG_MAX_TEXT    500
#define MSG_MAX_NEEDS   1024
#define MSG_MAX_PARAMS  4096
#define MSG_MAX_ORIGIN  4096 /* of header lines, where a picture is from */
#define MSG_MAX_STATE   16
#define MSG_MAX_VIEW    1024

#define MSG_MAX_FILES  16384  /* hashes in one list */
#define MSG_MAX_COSTS  (1u << 23)  /* lines of a job whose costs are given */
#define MSG_MAX_FRAMES 65536       /* of a job */
#define MSG_MAX_VIEWS  (64u << 20) /* bytes of the file that frames come in */
#define MSG_MAX_SIDE   65535  /* columns or rows that are rendered */
#define MSG_MAX_OVERSAMPLE 8
#define MSG_MIN_CLAMP      1. /* where it is not 0 */
#define MSG_MAX_CLAMP      1000.

#define MSG_MAX_THREADS 4096                /* of a worker */
#define MSG_MAX_BYTES   (UINT64_C(1) << 50) /* of a file, or a bundle */
#define MSG_MAX_DATE    UINT64_C(253402300799) /* the end of the year 9999 */

#define MSG_HASH  32 /* bytes of a SHA-256 */
#define MSG_JOB   16 /* bytes of a job's id */
#define MSG_TOKEN 16 /* bytes of a peer's token */

enum msg_type {
#define MSG(NAME, name, body, number, since, bytes, limit, at)                 \
    MSG_##NAME = number,
#include "proto/message.def"
};

/* Where a message arrives: who reads it, and in which state. */
enum msg_session {
    MSG_AT_COORD_NEW,    /* coordinator: a connection before its HELLO */
    MSG_AT_COORD_WORKER, /* coordinator: from a worker */
    MSG_AT_COORD_USER,   /* coordinator: from radsubmit or radctl */
    MSG_AT_COORD_ADMIN,  /* coordinator: the same, of an admin */
    MSG_AT_DIALLER,      /* worker or client: HELLO sent, no answer yet */
    MSG_AT_WORKER,       /* worker: from the coordinator */
    MSG_AT_CLIENT,       /* radsubmit, radctl: from the coordinator */
    MSG_AT_PEER_NEW,     /* worker: a peer's connection before PEER-HELLO */
    MSG_AT_PEER,         /* worker: from a peer of the same job */
    MSG_AT_CHILD_NEW,    /* job's child: before JOB-START */
    MSG_AT_CHILD,        /* job's child: from its radd */
    MSG_AT_PARENT_NEW,   /* radd: from a child that is not READY yet */
    MSG_AT_PARENT,       /* radd: from a child */
    MSG_NSESSION
};

enum msg_role { MSG_ROLE_WORKER = 1, MSG_ROLE_USER, MSG_ROLE_ADMIN };

enum msg_partition {
    MSG_PART_AUTO,
    MSG_PART_STATIC,
    MSG_PART_SCANBAR,
    MSG_PART_WINDOW,
    MSG_NPART
};

enum msg_order {
    MSG_ORDER_FORWARD,
    MSG_ORDER_BACKWARD,
    MSG_ORDER_RANDOM,
    MSG_ORDER_COST,
    MSG_NORDER
};

/* Flags of a job. */
#define MSG_JOB_DEPTH        (1u << 0) /* distances are wanted */
#define MSG_JOB_SHARE        (1u << 1) /* ambient records are shared */
#define MSG_JOB_FRESH_FRAMES (1u << 2) /* nothing kept between frames */
#define MSG_JOB_NO_BALANCE   (1u << 3)
#define MSG_JOB_SAME_BITS    (1u << 4) /* workers of one fingerprint only */
#define MSG_JOB_RECORDS      (1u << 5) /* RECORDS are wanted */
#define MSG_JOB_CODED        (1u << 6) /* rows come coded: the coordinator's */
#define MSG_JOB_VIEWS        (1u << 7) /* frames and costs are in a file */
#define MSG_JOB_FLAGS        255u      /* all of them */
#define MSG_JOB_FLAGS_1      31u       /* those of version 1 */

/* What FETCH asks for. */
enum msg_what {
    MSG_WHAT_PICTURE, /* bytes of FRAME.hdr */
    MSG_WHAT_DEPTH,   /* distances, as floats in the machine's order */
    MSG_WHAT_STATS,   /* JSON of the statistics */
    MSG_WHAT_PREVIEW, /* a .hdr of the rows so far, black where none is */
    MSG_NWHAT
};

/* What QUERY asks for; the answer is JSON. */
enum msg_topic {
    MSG_QUERY_STATUS,
    MSG_QUERY_WORKERS,
    MSG_QUERY_JOBS,
    MSG_QUERY_JOB, /* text: the job's id, or the beginning of it, in hex */
    MSG_QUERY_LIMITS, /* since version 2; text: the user, empty: who asks */
    MSG_NQUERY
};

/* --- session --- */

/* When [min, max] leaves all of our versions out, the fields after role are not
 * read (another version may have others) and are empty. */
struct msg_hello {
    uint16_t min, max;    /* versions that the sender speaks */
    uint8_t role;         /* enum msg_role that it asks for */
    const char *name;     /* worker's name; may be empty for the others */
    const char *program;  /* "radd 0.1.0" */
    const char *address;  /* where peers dial it: "tcp 127.0.0.1:41234" or
                           * "unix /path"; empty: nowhere */
    uint16_t threads;     /* of a worker */
    uint64_t fingerprint; /* numeric fingerprint; 0 before a job is loaded */
};

struct msg_welcome {
    uint16_t version;
    uint64_t epoch; /* life of the coordinator */
    const char *program;
};

/* status: of sysexits.h, here and below. */
struct msg_refuse {
    uint16_t status;
    const char *text;
};

/* PING and PONG, which repeats the number. */
struct msg_ping {
    uint64_t progress; /* grows while the sender gets on with its work */
};

struct msg_bye {
    const char *text;
};

/* --- store --- */

/* OFFER, WANT, and part of a job's spec: hashes lie one after another, MSG_HASH
 * bytes each. */
struct msg_hashes {
    uint32_t n;
    const uint8_t *hash;
};

/* A piece of a file, or of the answer to a FETCH (then hash is zero and the
 * request id says which).  Pieces come in order; the last ends at total; an
 * empty file is one empty piece. */
struct msg_chunk {
    const uint8_t *hash;
    uint64_t offset, total;
    const uint8_t *data;
    size_t len;
};

/* The file is stored whole. */
struct msg_have {
    const uint8_t *hash;
};

/* --- jobs --- */

struct msg_frame {
    uint32_t number;        /* 0 for a still, the view's number in an
                             * animation */
    uint32_t width, height; /* pixels that are rendered */
    const char *view;       /* rpict's view options */
};

#define MSG_FRAME_BYTES 15 /* on the wire, but for the view's text */

/* SUBMIT, JOB-START: what a job is, the same for the coordinator, a worker and
 * a child. */
#define MSG_SPEC_ADDED 12 /* bytes of origin, oversample and clamp, if none */
struct msg_spec {
    const uint8_t *job;      /* id, MSG_JOB bytes, made by radsubmit */
    const uint8_t *manifest; /* hash of the bundle's manifest */
    const char *name;
    const char *params;   /* rad_params_format() */
    const char *origin;   /* header lines of its pictures that say where they
                           * are from, each with its newline; or "" */
    const char *needs;    /* features the scene uses, blanks between */
    const char *estimate; /* --estimate, "uniform" by default */
    uint32_t ncosts;      /* 0: none, or the base lines of all frames */
    const uint8_t *costs; /* of each line of each frame, in any unit: as many
                           * floats on the wire (wire_floats_get), none below
                           * 0 */
    uint64_t seed;
    int32_t priority;
    uint32_t flags;    /* MSG_JOB_... */
    uint8_t partition; /* enum msg_partition */
    uint8_t order;     /* enum msg_order */
    uint32_t windows;  /* 0: by the picture's size */
    uint32_t objects;  /* in the scene, for the statistics */
    uint64_t bundle_bytes;
    double compile_s;
    uint32_t memory_mib; /* most memory of its process on a worker; 0: as much
                          * as that has for it */
    uint8_t oversample; /* samples a side of each pixel of the picture that is
                         * written, which is filtered down from what is
                         * rendered (image/filter.h); 0 or 1: none */
    double clamp;       /* most weight of a sample, times that of those about
                         * it; 0: any.  Else oversample is 2 at least */
    struct msg_hashes files; /* all of the bundle, the manifest among them */
    uint32_t nframes;
    const struct msg_frame *frames; /* NULL: they are in a file, not yet read */
    /* with MSG_JOB_VIEWS: */
    const uint8_t *views;   /* hash of that file, one of `files` */
    uint32_t width, height; /* the largest of any frame [pixels] */
};

/* The job is in the queue, whole. */
struct msg_accept {
    const uint8_t *job;
    uint8_t again; /* it was there already: attached to it */
};

/* Pixels that were no numbers, or infinite or negative, and are black. */
struct msg_nan {
    uint64_t pixels;
    uint32_t frame, x, y; /* the first of them, by frame, y, x; 0 when there
                           * are none */
};

/* Functions that failed to give a value: of which objects of the scene, and how
 * often.  The first few by number; a count of 0 ends them. */
#define MSG_FAULTS 4
struct msg_fault {
    uint32_t object;
    uint64_t count;
};

/* of those that a PROGRESS has: what others than the coordinator act on */
#define MSG_STATE_WAITING   0
#define MSG_STATE_RUNNING   1
#define MSG_STATE_PAUSED    2
#define MSG_STATE_FAILED    4
#define MSG_STATE_CANCELLED 5
#define MSG_STATE_HELD      6

struct msg_progress {
    const uint8_t *job; /* zero: of one that is not accepted yet */
    uint8_t state;      /* enum job_state of daemon/desk/job.h: 0 waiting,
                         * 1 running, 2 paused, 3 done, 4 failed,
                         * 5 cancelled; or MSG_STATE_HELD: the coordinator has
                         * no room on its disk */
    uint64_t pixels_done, pixels_total;
    uint32_t units_done, units_total, units_redone;
    double cost_done, cost_total; /* estimated; same unit for both; of units
                                   * under way by the pixels they are past */
    uint64_t rays;
    uint32_t workers;      /* that work on the job now */
    uint32_t frames_ready; /* the first so many frames can be fetched */
    double elapsed_s;      /* since the job was accepted */
    struct msg_nan nan;    /* in the units that are done; frame as named */
    struct msg_fault faults[MSG_FAULTS]; /* in them, too */
    double error; /* relative, as estimated of them; 0: nothing is known */
};

struct msg_done {
    const uint8_t *job;
    uint32_t frames;
};

/* A job, or the request that this answers, failed; the job's id is zero when
 * it is about none. */
struct msg_failed {
    const uint8_t *job;
    uint16_t status;
    const char *text;
};

/* CANCEL, PAUSE, RESUME, DELETE, JOB-END. */
struct msg_jobid {
    const uint8_t *job;
};

#define MSG_MOST_PRIORITY 100 /* and least, below 0, that a job may have */
struct msg_priority {
    const uint8_t *job;
    int32_t priority; /* higher goes first */
};

struct msg_fetch {
    const uint8_t *job;
    uint32_t frame; /* index, from 0 */
    uint8_t what;   /* enum msg_what */
};

struct msg_query {
    uint8_t what; /* enum msg_topic */
    const char *text;
};

/* Which list PAGE asks for a part of. */
enum msg_rows { MSG_ROWS_JOBS, MSG_ROWS_WORKERS, MSG_NROWS };

/* Some rows of a list of any length.  The answer has as many as are good to
 * send at once, and the cursor for the rows behind them, which holds good
 * whatever comes and goes meanwhile. */
struct msg_page {
    uint8_t what;      /* enum msg_rows */
    uint8_t mine;      /* 1: of jobs the asker's own alone */
    const char *user;  /* of jobs those of that owner; empty: of any */
    const char *state; /* those in that state, or jobs that are "open" (not
                        * over) or "over"; empty: in any */
    uint64_t cursor;   /* from the answer before; 0: from the start */
    uint32_t most;     /* rows; 0: no limit */
};

/* JSON; not terminated.  Empty as the answer to CANCEL and the like. */
struct msg_answer {
    const uint8_t *text;
    size_t len;
};

/* What KEY asks for. */
enum msg_key_order { MSG_KEY_ADD, MSG_KEY_RETIRE, MSG_KEY_LIST, MSG_NKEY };

/* An order about the coordinator's keys (keyfile.h); the answer is JSON. */
struct msg_key {
    uint8_t what;     /* enum msg_key_order */
    const char *name; /* "worker:ws07", "worker:ws07:k1"; empty for LIST */
    uint64_t expires; /* of a new key, seconds since 1970; 0: never */
};

/* DRAIN, UNDRAIN, FORGET: a worker's name. */
struct msg_worker {
    const char *name;
};

/* --- work --- */

struct msg_ready {
    const uint8_t *job;
    double load_s;
    uint64_t fingerprint;
    uint16_t threads;
};

/* How far pixels may be off: sums of src/trace/job.h and src/picture/doubt.h.
 * None is negative, and each below 1e100. */
struct msg_doubt {
    double pixels, variance, known, all; /* of indirect light */
    double rough, nrough;                /* of base lines */
};

/* What one unit cost; nan.frame is the unit's and does not travel. */
struct msg_counts {
    uint64_t rays, primary_rays, speculative_rays, shadow_rays, ambient_rays,
        paint_rays, estimate_rays, intersection_tests, ambient_values;
    struct msg_nan nan;
    struct msg_fault faults[MSG_FAULTS];
    double cpu_s;  /* processor time of the render threads */
    double wall_s; /* from taking the unit to its last row; of a strict unit,
                    * that of its passes (daemon/strict/strict.h) */
    struct msg_doubt doubt;
};

/* Rows of a unit, from its top, each piece following the last.  Pixels are
 * r g b, or r g b distance with channels 4, as floats on the wire
 * (wire_floats_get); with channels 1, of jobs with MSG_JOB_CODED, rows as in a
 * picture file (rad_hdr_encode_row()), which are looked at by whoever takes
 * them apart.  counts only with last; zero else. */
struct msg_result {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t row, rows, width; /* row from the unit's top */
    uint8_t channels;          /* 3 or 4; 1: coded */
    uint8_t last;
    struct msg_counts counts;
    const uint8_t *pixels; /* rows * width * channels floats, or coded, */
    size_t len;            /* so many bytes; only read of those */
};

struct msg_ack {
    const uint8_t *job;
    uint32_t unit, attempt, row, rows;
};

/* REVOKE, TWIN, PARKED, RESUMED, SPLIT: one worker's go at a unit. */
struct msg_attempt {
    const uint8_t *job;
    uint32_t unit, attempt;
};

/* The job's child ended by itself; units are those it was at work on, the
 * likely causes. */
struct msg_lost {
    const uint8_t *job;
    const char *text; /* "killed by signal 11" */
    uint32_t nunits;
    const uint32_t *units;
};

/* Whether a worker finds room for the files of a job that it was to begin. */
struct msg_room {
    const uint8_t *job;
    uint8_t has;      /* 1: it may be told to begin; 0: not now */
    const char *text; /* why not */
};

/* What a worker did for a job so far; the last one counts. */
struct msg_tally {
    const uint8_t *job;
    uint64_t ambient_sent, ambient_received, ambient_redundant;
    uint64_t peak_rss_bytes, bytes_in, bytes_out;
    uint64_t base_line_bytes;  /* sent in BASE_LINEs, to peers and up */
    uint64_t base_line_pixels; /* of the base lines that were made */
    /* summed over render threads */
    double busy_s;           /* on units, waits and all */
    double wait_base_line_s; /* of that, for the line above */
    uint64_t rays_under_way; /* of units that are not done */
    /* of strict units and loans that were taken back, which are in no RESULT
     * and no PAID: twins that were not first.  No primary rays, nan or faults;
     * speculative are facts that nobody was told of. */
    struct msg_counts dropped;
    struct msg_counts seeded; /* of SEEDs; no primary rays, nan or faults */
    /* all PAIDs that went up of this child: what of them did not arrive, since
     * the connection broke, is known by it */
    struct msg_counts paid;
    uint64_t pixels_under_way; /* of strict units that are not done: those that
                                * passes are past, whose rows are not out */
};

/* --- sharing a picture ---
 *
 * Line i of a frame stands for base line i (quincunx.h) and the bar above it:
 * the rows from the one below base line i-1 to that of base line i; line 0 is
 * row 0 alone.  A strict unit is whole lines of one frame, as wide as it; its
 * top is the base line above it, its bottom the last of its own.
 * A fact is the value of a pixel that was traced with a ray, before painting.
 * Facts are pure: they may come in any order, twice, or never. */

enum msg_mode {
    MSG_MODE_WINDOW, /* sampled by itself */
    MSG_MODE_STRICT, /* lines of the whole frame */
    MSG_NMODE
};

/* Where a unit's worker begins each bar when it works ahead of the truth, so
 * that twins meet late. */
enum msg_end {
    MSG_END_LEFT,  /* left to right */
    MSG_END_RIGHT, /* right to left */
    MSG_END_MIDDLE_RIGHT,
    MSG_END_MIDDLE_LEFT,
    MSG_NEND
};

#define MSG_UNIT_TOP                                                           \
    (1u << 0)                   /* trace the base line above it too, ahead of  \
                                 * all: nobody has it; out as FACTS */
#define MSG_UNIT_TWIN (1u << 1) /* others have it too: FACTS as they come */
#define MSG_UNIT_BARS                                                          \
    (1u << 2) /* version 2: its bars are made along with its base lines, from  \
               * the top, for what is below has time to wait */
#define MSG_UNIT_FLAGS 7u /* all of them */

/* x, y of the top left pixel, y from the top. */
struct msg_unit {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t frame; /* index into the job's frames */
    uint32_t x, y, width, height;
    uint8_t mode;  /* enum msg_mode */
    uint8_t end;   /* enum msg_end */
    uint8_t flags; /* MSG_UNIT_...; none with MSG_MODE_WINDOW */
};

#define MSG_FACTS_ESTIMATE (1u << 0) /* traced for an estimate */
#define MSG_FACTS_FLAGS    1u        /* all of them */

#define MSG_MAX_LINE_ROWS 32 /* a line has no more rows */

/* Facts of one line.  Pixels outside of a view cost no ray and are none. */
struct msg_facts {
    const uint8_t *job;
    uint32_t frame, line;
    uint32_t row, rows; /* row from the line's top, where a bar's rows come
                         * first and the base line last */
    uint32_t width;     /* of the picture */
    uint8_t flags;      /* MSG_FACTS_... */
    uint8_t channels;   /* 3 or 4, as in a RESULT */
    /* (width + 7) / 8 bytes for each row: pixel x is 1 << x % 8 of byte x / 8;
     * bits past the width are 0 */
    const uint8_t *bitmap;
    const uint8_t *pixels; /* of the bits that are set: channels floats each */
    uint32_t npixels;      /* that many; known after unpacking */
};

/* A true piece of a base line, as it is made. */
struct msg_base_line {
    const uint8_t *job;
    uint32_t frame, line;
    uint32_t x, n;            /* columns of pixels */
    uint32_t first, ndensity; /* densities */
    uint8_t channels;         /* 3 or 4 */
    const uint8_t *density;
    const uint8_t *pixels; /* as in the picture: n * channels floats */
};

/* Who waits for a base line. */
struct msg_next_holder {
    const uint8_t *job;
    uint32_t frame, line;
    const char *name; /* a worker's; empty: nobody */
};

/* GAVE: what was left after SPLIT or YIELD.  STILL: what a worker that comes
 * back has.
 */
struct msg_gave {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t height; /* rows from now on; GAVE: as before: nothing was given, 0:
                      * all of it */
};

/* Before the first unit: make the deep ambient records of a part of space, the
 * others making theirs.  Parts are intervals of the order that all of them put
 * what rays meet in (src/picture/seed.h). */
#define MSG_SEED_ALL 65536u
struct msg_seed {
    const uint8_t *job;
    uint32_t first, last; /* from the first up to below the last, of all */
};

/* Lend columns of the unit's last line to another worker. */
struct msg_lend {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint16_t part; /* of what is left of it, in 65536ths */
};

#define MSG_LOAN_LINE  (1u << 0) /* of the base line, too, not the bar alone */
#define MSG_LOAN_FLAGS 1u        /* all of them */

/* Columns of a line that whoever lends them does not trace until BACK; and what
 * it takes to know which of their pixels count.  Up: what comes of LEND, with
 * the lender's unit and attempt.  Down: with those of the one that gets them,
 * who sends FACTS, and PAID when that is all. */
struct msg_loan {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t frame, line;
    uint32_t x, n;        /* columns, at least 1 */
    uint16_t given, left; /* of the line's cost, in 65535ths: that, and what is
                           * the lender's own */
    uint8_t flags;        /* MSG_LOAN_... */
    uint8_t channels;     /* 3 or 4 */
    uint32_t ndensity;    /* with MSG_LOAN_LINE: of the line above, all */
    const uint8_t *density;
    const uint8_t *wanted; /* (n + 7) / 8 bytes: column x + i of the bar is to
                            * be filled if bit i % 8 of byte i / 8 is set */
    const uint8_t *top;    /* base line above, as in the picture: n * channels
                            * floats */
    const uint8_t *bottom; /* without MSG_LOAN_LINE: the base line as it was
                            * sampled; as long */
};

/* Columns that were lent are the lender's again: what there is of them came as
 * FACTS. */
struct msg_back {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t line, x, n; /* n 0: all that it lends */
};

/* All that was lent is traced, and forgotten: what that cost is the unit's. */
struct msg_paid {
    const uint8_t *job;
    uint32_t unit, attempt;
    struct msg_counts counts; /* no primary rays, no nan: the lender has them */
};

/* What a worker spent on lines, for units and loans that are done: processor
 * time of its render threads.  All of a line's are to be added. */
struct msg_line_costs {
    const uint8_t *job;
    uint32_t frame, line; /* the first of them */
    uint32_t nlines;
    const uint64_t *cpu_ns;
};

struct msg_area {
    uint32_t frame; /* index into the job's frames */
    uint32_t x, y, width, height;
};

/* Trace a few random pixels of each area, the same whoever does it. */
struct msg_estimate {
    const uint8_t *job;
    uint32_t id;
    uint32_t rays; /* in each area */
    uint32_t nareas;
    const struct msg_area *areas;
};

struct msg_cost {
    uint64_t rays, tests; /* tests: of intersection */
};

/* What they cost, in the order of the ESTIMATE of that id. */
struct msg_estimated {
    const uint8_t *job;
    uint32_t id;
    uint32_t ncosts;
    const struct msg_cost *costs;
    struct msg_counts counts; /* of all of it; cpu_s and wall_s are there */
};

/* --- peers --- */

#define MSG_PEER_DIAL (1u << 0) /* you dial; else wait for its call */
#define MSG_PEER_GIVE (1u << 1) /* send it all that your cache holds */
#define MSG_PEER_DROP (1u << 2) /* have no more to do with it; alone */

struct msg_peer {
    const char *name, *address;
    const uint8_t *token; /* MSG_TOKEN bytes, of this pair and job */
    uint32_t flags;
    uint16_t version; /* that the two speak: the highest that both do */
};

/* New peers of a job, besides those named before. */
struct msg_job_peers {
    const uint8_t *job;
    uint32_t npeers;
    const struct msg_peer *peers;
};

/* To whom a worker sends ambient records, where there are too many workers for
 * all to be linked (daemon/links/ring.h): each has a place on a ring, or one on it
 * speaks for it. */
struct msg_ring_link {
    uint32_t offset; /* so many places on; 0: one that has none */
    uint32_t below;  /* what comes from fewer places back than that goes there,
                      * at most offset; with offset 0 it is 0 */
    const char *name;
};

/* All of them: those of before do not count any more. */
struct msg_ring {
    const uint8_t *job;
    uint32_t generation;
    uint32_t places; /* on the ring; 0: this worker has none */
    uint8_t direct;  /* 1: all are linked with all besides, and what is urgent
                      * goes to each, as does all without places */
    uint32_t nlinks;
    const struct msg_ring_link *links;
};

/* The link to a worker of the ring is gone, or never came about. */
struct msg_unlinked {
    const uint8_t *job;
    const char *name;
    uint8_t was; /* 1: it was there; 0: it never came about */
};

/* Records that one worker made. */
struct msg_part {
    uint32_t distance; /* places from there to who is sent this, from 1 */
    uint32_t count;    /* records */
    const uint8_t *data;
    size_t len;
};

/* Records on their way about the ring. */
struct msg_spread {
    uint32_t generation; /* of the ring that the distances are of */
    uint32_t nparts;
    const struct msg_part *parts;
};

struct msg_peer_hello {
    const uint8_t *job;
    const char *name;
    const uint8_t *token;
};

/* A batch of ambient records, opaque here (proto/ambshare.c packs them). */
struct msg_ambient {
    uint32_t to;    /* child to radd: the GIVE that it answers, 0: all peers */
    uint32_t count; /* records */
    const uint8_t *data;
    size_t len;
};

/* Ambient records that a worker has made, for the radsubmit of a job that wants
 * them (MSG_JOB_RECORDS), by way of the coordinator. */
struct msg_records {
    const uint8_t *job;
    uint32_t count; /* records */
    const uint8_t *data;
    size_t len;
};

/* radd to child: send every record you have, in AMBIENTs with this `to`. */
struct msg_give {
    uint32_t to;
};

struct msg {
    uint16_t type;    /* enum msg_type */
    uint32_t request; /* a reply repeats its request's; 0 where none is due */
    union {
#define MSG(NAME, name, body, number, since, bytes, limit, at)                 \
    struct msg_##body name;
#include "proto/message.def"
    };
    /* scratch of the unpacked list; see msg_release() */
    void *list;
    size_t list_size;
};

/* A struct msg starts as { .type = MSG_X, ... } for packing, or { 0 } for
 * unpacking; release what was unpacked into. */
void msg_release(struct msg *m);

/* Append m as one whole frame, header and payload, to out (whose max should
 * leave room for MSG_FRAME_MAX bytes).  0, RAD_EPROTO when a field is out of
 * its bounds, or RAD_ENOMEM; out is as before then. */
int msg_pack(struct wire_out *out, const struct msg *m);

/* The same for somebody who speaks that version: what it does not know is left
 * out, where that does no harm.  RAD_EPROTO, too, for a message that it does
 * not have. */
int msg_pack_as(unsigned version, struct wire_out *out, const struct msg *m);

/* The type of a whole frame of ours; 0: it is none. */
uint16_t msg_frame_type(const uint8_t *frame, size_t n);

/* Make of a whole frame of ours, of the current version, one of that version.
 * 1: it is appended to out; 0: it has the same bytes; or RAD_EPROTO as above.
 */
int msg_frame_as(unsigned version, struct wire_out *out, const uint8_t *frame,
                 size_t n);

/* Decode a payload of n bytes.  0, or RAD_EPROTO: fields missing, out of
 * range, or bytes left over; or RAD_ENOMEM. */
int msg_unpack(struct msg *m, uint16_t type, uint32_t request,
               const uint8_t *payload, size_t n, struct rad_error *err);

/* The same for one in the bytes of that version.  Fields that came later are
 * zero. */
int msg_unpack_as(unsigned version, struct msg *m, uint16_t type,
                  uint32_t request, const uint8_t *payload, size_t n,
                  struct rad_error *err);

/* The file that a job's frames come in, and the costs of their lines
 * (MSG_JOB_VIEWS), appended to out.  0; RAD_EPROTO: there are too many of them;
 * RAD_ENOMEM. */
int msg_views_pack(struct wire_out *out, const struct msg_spec *spec);

/* Make of its n bytes, which are lent, the frames and costs of a spec that says
 * how many frames there are and how large; room is kept in *m, as by
 * msg_unpack().  RAD_EDATA, or RAD_ENOMEM. */
int msg_views_unpack(struct msg *m, struct msg_spec *spec, const uint8_t *bytes,
                     size_t n, struct rad_error *err);

/* The highest of our versions in [min, max]; 0: none is. */
unsigned msg_common_version(unsigned min, unsigned max);

/* Add the pixels of b; the first of both is kept. */
void msg_nan_add(struct msg_nan *a, const struct msg_nan *b);

/* Add b's faults to a's. */
void msg_faults_add(struct msg_fault a[MSG_FAULTS],
                    const struct msg_fault b[MSG_FAULTS]);

/* Add what b says of rays and of what came of them: not of pixels and time. */
void msg_rays_add(struct msg_counts *a, const struct msg_counts *b);

/* Add all of b. */
void msg_counts_add(struct msg_counts *a, const struct msg_counts *b);
/* What a sum has that another has not, field by field; nothing of primary rays,
 * nan, faults and wall_s. */
void msg_counts_lack(struct msg_counts *out, const struct msg_counts *all,
                     const struct msg_counts *have);
void msg_doubt_add(struct msg_doubt *a, const struct msg_doubt *b);

/* "JOB-START"; "?" for a number that is no message. */
const char *msg_name(uint16_t type);

/* Largest payload; 0 for a number that is no message. */
size_t msg_limit(uint16_t type);

/* The version that brought it, and the one that last changed its bytes; 0 for a
 * number that is no message. */
unsigned msg_since(uint16_t type);
unsigned msg_bytes_since(uint16_t type);

/* May this type arrive there?  Default: no. */
bool msg_allowed(enum msg_session session, uint16_t type);

/* Walk the table: the i-th message's number, 0 past the end. */
uint16_t msg_nth(size_t i);

/* A job's id as 32 hex digits and back; false when text is no id. */
#define MSG_JOB_HEX (2 * MSG_JOB + 1)
void msg_job_format(const uint8_t job[MSG_JOB], char hex[MSG_JOB_HEX]);
bool msg_job_parse(const char *hex, uint8_t job[MSG_JOB]);

#endif
