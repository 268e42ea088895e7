/* msg_session.h - the messages by which two programs get to know each other
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_SESSION_H
#define MSG_SESSION_H

#include "proto/msg_basics.h"

/* If [min, max] has none of our versions, the fields after role are empty: they
 * are not read, for that version may lay them out in another way. */
struct msg_hello {
    uint16_t min, max;    /* versions that the sender speaks */
    uint8_t role;         /* enum msg_role that the sender asks for */
    const char *name;     /* worker's name; may be empty for the others */
    const char *program;  /* "radd 0.1.0" */
    const char *address;  /* where peers dial it: "tcp 127.0.0.1:41234" or
                           * "unix /path"; empty: nowhere */
    uint16_t threads;     /* of a worker */
    uint64_t fingerprint; /* numeric fingerprint; 0 before a job is loaded */
};

struct msg_welcome {
    uint16_t version;
    uint64_t epoch; /* rises with each start of the coordinator */
    const char *program;
};

/* status: of sysexits.h, as in every message that has one. */
struct msg_refuse {
    uint16_t status;
    const char *text;
};

/* PING, and PONG, which repeats PING's numbers. */
struct msg_ping {
    uint64_t progress; /* grows while the sender makes progress */
    uint32_t load;     /* of a worker's host: processes that run or wait for a
                        * processor, in hundredths, over the last minute */
};

struct msg_bye {
    const char *text;
};

#endif
