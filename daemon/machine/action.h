/* action.h - what the pure machines want done
 *
 * coord.c and worker.c take events and append actions; the shell around them
 * carries the actions out, in order.  An event that this causes may be
 * delivered at once: its actions come after those that are there.  What an
 * action points at is valid until actions_clear(); the chunk of ACT_PUT_CHUNK
 * and the pixels of ACT_PUT_ROWS as long as the message that brought them.
 *
 * Connections have numbers: the shell chooses those of connections that came
 * in, the machine those that it asks for (ACT_DIAL, ACT_SPAWN), with
 * ACT_OWN_CONN set.  0 is none; a number is never used again.
 * Thread: an action list belongs to one thread. */
#ifndef DAEMON_ACTION_H
#define DAEMON_ACTION_H

#include "base/arena.h"
#include "proto/message.h"
#include "machine/saved.h"

#define ACT_OWN_CONN (UINT64_C(1) << 63)

enum action_type {
    /* both daemons */
    ACT_SEND,      /* conn, bytes: a whole frame of the current version; never
                    * dropped */
    ACT_SESSION,   /* conn, session, version: what may arrive from now on, and
                    * what the other side speaks */
    ACT_CLOSE,     /* conn: close once what was sent is out; its closed event
                    * still comes */
    ACT_LOG,       /* level, text */
    ACT_PUT_CHUNK, /* conn, chunk: keep a piece of a file; when whole and its
                    * hash right: file_stored, else file_failed */
    /* coordinator */
    ACT_SEND_FILE,     /* conn, request, hash: as CHUNKs, at the pace of the
                        * connection; FAILED if it cannot be read */
    ACT_JOB_OPEN,      /* job: keep it, with room for rows; coord_job_opened */
    ACT_JOB_STATE,     /* job, status, priority: an enum job_state and a
                        * priority to keep */
    ACT_DRAINED,       /* text, status: to keep whether that worker is drained,
                        * 1 or 0 */
    ACT_JOB_END,       /* job, bytes: it is over; keep how, and bytes as its
                        * statistics (actions_take); then coord_job_filed */
    ACT_KEEP_UNIT,     /* job, unit: remember it some time, before any of its
                        * rows */
    ACT_PUT_PASS,      /* job, frame, pass: keep that pass if there is room */
    ACT_PUT_COLOURS,   /* job, colours: to show in previews; nobody waits */
    ACT_LOAD_CACHE,    /* job: read what it begins with; coord_cache_came */
    ACT_DROP_CACHE,    /* job: the cache kept of it goes; coord_job_filed */
    ACT_OPTIONS,       /* job, text: rendering options of its pictures, now */
    ACT_SETTLE,        /* conn, request: coord_settled when all that was asked
                        * to be kept before is */
    ACT_PUT_ROWS,      /* rows: keep; then coord_rows_stored */
    ACT_WRITE_PICTURE, /* job, frame: whole; then coord_picture_written */
    ACT_SEND_PICTURE,  /* conn, request, job, frame, what: as CHUNKs; FAILED
                        * with that request if there is none */
    ACT_JOB_FETCHED,   /* job, frame: note on the disk */
    ACT_JOB_FORGET,    /* gone: remove its files */
    ACT_KEY,           /* conn, request, key, text: for that admin; answer */
    /* worker */
    ACT_DIAL,  /* conn, text: address; empty: the coordinator's, with our own
                * key; else with that of job and token (tls_peer_key).  Then
                * opened (an ACT_SESSION follows) or closed */
    ACT_SPAWN, /* conn, job, memory_mib: start a child, session
                * MSG_AT_PARENT_NEW; frames may be sent at once.  Then
                * child_ended, once */
    ACT_KILL,  /* conn: end that child; no event follows */
    ACT_STOP   /* leave with an exit status; text says why, or is empty */
};

/* Rows of one RESULT, and the key that comes back when they are kept. */
struct action_rows {
    uint64_t conn; /* worker's connection */
    uint8_t job[MSG_JOB];
    uint64_t sequence; /* of the job: another may have its id by the time */
    uint32_t unit, attempt;
    uint32_t row, rows; /* in the unit */
    uint32_t frame;     /* index */
    uint32_t x, y;      /* of the first pixel, in the picture */
    uint32_t width;
    uint8_t channels; /* 3 or 4; 1: coded */
    uint8_t last;     /* of its unit */
    /* not in the key */
    const uint8_t *pixels;           /* floats as on the wire, or coded */
    size_t len;                      /* bytes of pixels that are coded */
    const struct msg_counts *counts; /* with last */
    const uint8_t *bottom;           /* likewise; see struct saved_unit */
    uint32_t nbottom;
    const uint8_t *line; /* with bottom of coded ones: the last row's colours,
                          * width * 3 floats as on the wire; NULL: none */
    uint64_t now_ms;
};

/* What every step-th pixel (of 8 to 256) of an area looks like so far. */
struct action_colours {
    uint32_t frame; /* index */
    int x, y, step, columns, rows;
    const uint8_t *rgbe; /* row by row */
};

/* Files that should be looked at before has_file is asked of them, which would
 * wait for the disk: it takes about a second for a gigabyte.  The whole comes
 * back when that is done, to say who asked. */
struct action_look {
    uint64_t conn;
    uint32_t request;
    uint8_t job[MSG_JOB];
    uint32_t nlook; /* the first so many of the files are to be looked at */
    struct msg_hashes files;
    uint64_t bytes; /* of all of them, by what the job says */
    int status;     /* of sysexits.h: they cannot be had, and why */
    char why[256];
};
/* Are they known, or missing?  If not, the event follows later.  The files are
 * copied.  A machine's env may have NULL for it: then all are. */
typedef bool action_look_fn(void *arg, const struct action_look *l);

enum action_level { ACT_ERR, ACT_WARN, ACT_INFO, ACT_DEBUG };

struct action {
    enum action_type type;
    uint64_t conn;
    uint32_t request;
    uint32_t frame; /* index */
    enum msg_session session;
    unsigned version;
    enum msg_what what;
    enum action_level level;
    const uint8_t *job, *hash; /* MSG_JOB, MSG_HASH bytes */
    uint64_t sequence; /* of the job, where an answer follows: by the time
                        * another may have its id */
    const uint8_t *token;      /* MSG_TOKEN bytes */
    struct msg_key key;
    const uint8_t *bytes;
    size_t len;
    const char *text;
    int status;          /* of sysexits.h */
    int32_t priority;
    uint32_t memory_mib; /* most that the job may use; 0: no limit of its own */
    struct msg_chunk chunk;
    struct action_rows rows;
    const struct saved_unit *unit;
    const struct saved_gone *gone;
    const struct saved_pass *pass;
    struct action_colours colours;
};

struct action_list {
    struct action *v;
    size_t n, cap;
    struct rad_arena mem;
    struct wire_out scratch; /* where messages are packed */
    char **texts;            /* that it owns, see actions_own() */
    size_t ntexts;
    bool failed;             /* memory is out: the daemon must end */
};

void actions_init(struct action_list *l);
void actions_release(struct action_list *l);
/* Forget the actions, after they were carried out. */
void actions_clear(struct action_list *l);

/* Append one, or one about a job, whose id is copied; NULL when memory is out
 * (l->failed is set). */
struct action *actions_add(struct action_list *l, enum action_type type,
                           uint64_t conn);
struct action *actions_add_job(struct action_list *l, enum action_type type,
                               uint64_t conn, const uint8_t job[MSG_JOB]);

/* Pack a message into an ACT_SEND.  A message of ours that cannot be packed is
 * a bug: it sets l->failed. */
void actions_send(struct action_list *l, uint64_t conn, const struct msg *m);

/* ACT_SEND of bytes that are a whole frame already: a copy, or these, which
 * were kept for several connections. */
void actions_send_bytes(struct action_list *l, uint64_t conn,
                        const uint8_t *bytes, size_t len);
void actions_send_kept(struct action_list *l, uint64_t conn,
                       const uint8_t *kept, size_t len);

/* Copies of what an action points at, which last as long as the actions.  NULL:
 * memory is out, and l->failed is set. */
void *actions_keep(struct action_list *l, const void *bytes, size_t len);
char *actions_keep_text(struct action_list *l, const char *text);

/* Take a text, malloc'd, that is too long to be copied: it is freed with the
 * actions, unless actions_take() got it.  False: memory is out; it is freed,
 * and l->failed is set. */
bool actions_own(struct action_list *l, char *text);
/* That text is the caller's from now on; NULL: it was not the list's. */
char *actions_take(struct action_list *l, const uint8_t *text);

void actions_session(struct action_list *l, uint64_t conn,
                     enum msg_session session, unsigned version);
void actions_close(struct action_list *l, uint64_t conn);

/* "fixed words key=value ...", one event a line. */
void actions_log(struct action_list *l, enum action_level level,
                 const char *fmt, ...) __attribute__((format(printf, 3, 4)));

#endif
