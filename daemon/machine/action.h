/* action.h - what the pure machines want done
 *
 * coord.c and worker.c take events and append actions; the shell around them
 * carries the actions out, in order.  An action may cause an event that is
 * delivered at once; the event's actions are appended behind all others.
 * Memory that an action points at is valid until actions_clear(), but the chunk
 * of ACT_PUT_CHUNK and the pixels of ACT_PUT_ROWS only as long as the message
 * that brought them.
 *
 * Each connection has a number.  The shell numbers connections that came in;
 * the machine numbers those that it asks for (ACT_DIAL, ACT_SPAWN), with
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
    ACT_SESSION,   /* conn, session, version: which messages may arrive from
                    * now on, and the version that the peer speaks */
    ACT_CLOSE,     /* conn: close once all that was sent is out; the closed
                    * event still comes */
    ACT_LOG,       /* level, text */
    ACT_PUT_CHUNK, /* conn, chunk: keep a piece of a file; then file_stored when
                    * the file is whole and its hash right, or file_failed */
    /* coordinator; behind the ';' the event that follows */
    ACT_SEND_FILE,     /* conn, request, hash: send the file as CHUNKs, at the
                        * connection's pace; an empty one if it is unreadable */
    ACT_DROP_FILES,    /* conn: do not send files that have not begun */
    ACT_JOB_OPEN,      /* job: keep, with room for rows; coord_job_opened */
    ACT_JOB_STATE,     /* job, status, priority: an enum job_state and a
                        * priority to keep */
    ACT_DRAINED,       /* text, status: keep whether the worker of that name is
                        * drained, 1 or 0 */
    ACT_JOB_END,       /* job, bytes: the job is over: keep how, and bytes as
                        * its statistics (actions_take); coord_job_filed */
    ACT_KEEP_UNIT,     /* job, unit: keep the unit, before any of its rows */
    ACT_PUT_PASS,      /* job, frame, pass: keep that pass if there is room */
    ACT_PUT_COLOURS,   /* job, colours: keep them for previews */
    ACT_LOAD_CACHE,    /* job: read its first records; coord_cache_came */
    ACT_DROP_CACHE,    /* job: remove its kept cache; coord_job_filed */
    ACT_OPTIONS,       /* job, text: new rendering options of its pictures */
    ACT_SETTLE,        /* conn, request: wait until all is kept that was asked
                        * to be kept before; coord_settled */
    ACT_PUT_ROWS,      /* conn, rows: keep what came there; coord_rows_stored */
    ACT_WRITE_PICTURE, /* job, frame: write it; coord_picture_written */
    ACT_SEND_PICTURE,  /* conn, request, job, frame, what: send as CHUNKs, or
                        * FAILED with that request if there is no such file */
    ACT_JOB_FETCHED,   /* job, frame: keep that the owner has the picture */
    ACT_JOB_FORGET,    /* gone: remove the job's files */
    ACT_KEY,           /* conn, request, key, text (the admin): do and answer */
    /* worker */
    ACT_DIAL,  /* conn, text: dial that address, with the key of job and token
                * (tls_peer_key); text "": the coordinator, with our own key.
                * Then opened (an ACT_SESSION follows) or closed */
    ACT_SPAWN, /* conn, job, memory_mib: start a child, session
                * MSG_AT_PARENT_NEW; frames may be sent at once.  Then
                * child_ended, once */
    ACT_KILL,  /* conn: end that child; no event follows */
    ACT_STOP   /* end with exit status `status`; text says why, or is empty */
};

/* Rows of one RESULT, and the key that comes back when they are kept. */
struct action_rows {
    uint8_t job[MSG_JOB];
    uint64_t sequence; /* of the job: another job may have its id by then */
    uint32_t part; /* of the worker that sent the rows: index in job.parts */
    uint32_t unit, attempt;
    uint32_t row, rows; /* in the unit */
    uint32_t frame;     /* index */
    uint32_t x, y, width; /* x, y: of the first pixel, in the picture */
    uint8_t channels; /* 3 or 4; 1: coded */
    uint8_t last;     /* of its unit */
    bool awaited;     /* last, and all units of the job are out: a user waits */
    /* not in the key */
    const uint8_t *pixels;           /* floats as on the wire, or coded */
    size_t len;                      /* bytes of pixels that are coded */
    const struct msg_counts *counts; /* with last */
    const uint8_t *bottom;           /* with last; see struct saved_unit */
    uint32_t nbottom;
    const uint8_t *line; /* with bottom, of coded rows: the last row's colours,
                          * width * 3 floats as on the wire; NULL: none */
    uint64_t date_ms;    /* when the rows came (desk.h) */
};

/* Colours so far of every step-th pixel (step 8 to 256) of an area. */
struct action_colours {
    uint32_t frame; /* index */
    int x, y, step, columns, rows;
    const uint8_t *rgbe; /* row by row */
};

/* Files to read and check before has_file is asked about them, for that would
 * wait for the disk, about a second for a gigabyte.  The struct comes back with
 * the event that follows, and says who asked. */
struct action_look {
    uint64_t conn;
    uint32_t request;
    uint8_t job[MSG_JOB];
    uint32_t nlook; /* the first so many of the files are to be looked at */
    struct msg_hashes files;
    uint64_t bytes; /* of all files, by the job's word */
    int status;     /* 0, or of sysexits.h: the files cannot be had, and why */
    char why[256];
};
/* Look at the files of *l, which is copied.  True: has_file can answer at once;
 * false: the event follows.  NULL in a machine's env: has_file always can. */
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
    uint64_t sequence; /* of the job, where an event follows: see action_rows */
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
    char **texts;            /* owned texts, see actions_own() */
    size_t ntexts;
    bool failed; /* memory is out: the daemon ends instead */
};

void actions_init(struct action_list *l);
void actions_release(struct action_list *l);
/* Forget the actions, after they were carried out. */
void actions_clear(struct action_list *l);

/* Append an action; append an action about a job, whose id is copied.  NULL:
 * memory is out, and l->failed is set. */
struct action *actions_add(struct action_list *l, enum action_type type,
                           uint64_t conn);
struct action *actions_add_job(struct action_list *l, enum action_type type,
                               uint64_t conn, const uint8_t job[MSG_JOB]);

/* Append an ACT_SEND of a message, which is packed.  A message of ours that
 * cannot be packed is a bug: it sets l->failed. */
void actions_send(struct action_list *l, uint64_t conn, const struct msg *m);

/* Append an ACT_SEND of a whole frame: of a copy; of the bytes themselves,
 * which actions_keep() copied for several connections. */
void actions_send_bytes(struct action_list *l, uint64_t conn,
                        const uint8_t *bytes, size_t len);
void actions_send_kept(struct action_list *l, uint64_t conn,
                       const uint8_t *kept, size_t len);

/* Copy bytes, or a text, to which an action is to point; the copy lasts as long
 * as the actions.  NULL: memory is out, and l->failed is set. */
void *actions_keep(struct action_list *l, const void *bytes, size_t len);
char *actions_keep_text(struct action_list *l, const char *text);

/* Take a malloc'd text that is too long to be copied: it is freed with the
 * actions, unless actions_take() gave it away.  False: memory is out, the text
 * is freed, and l->failed is set. */
bool actions_own(struct action_list *l, char *text);
/* Give an owned text to the caller, who frees it; NULL: it is not owned. */
char *actions_take(struct action_list *l, const uint8_t *text);

void actions_session(struct action_list *l, uint64_t conn,
                     enum msg_session session, unsigned version);
void actions_close(struct action_list *l, uint64_t conn);

/* Append an ACT_LOG of "fixed words key=value ...", one event a line. */
void actions_log(struct action_list *l, enum action_level level,
                 const char *fmt, ...) __attribute__((format(printf, 3, 4)));

#endif
