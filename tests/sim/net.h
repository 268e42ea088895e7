/* net.h - a network in virtual time, under a seed
 *
 * Nodes are joined by links that carry bytes both ways.  Each direction keeps
 * its order, as TCP does; links overtake each other freely.  Bytes arrive in
 * pieces and pass through the real frame reader.
 *
 * A check that fails prints the seed and ends the program. */
#ifndef SIM_NET_H
#define SIM_NET_H

#include "proto/frame.h"
#include "event.h"

struct net;

enum { NET_NODES = 128 };

/* What a kind of node does. */
struct node_ops {
    void (*message)(struct net *net, int node, uint64_t conn,
                    const struct msg *m);
    void (*closed)(struct net *net, int node, uint64_t conn);
};

struct net_end {
    int node;
    uint64_t conn;
    bool open;
    bool deaf; /* the link is cut: what is under way is lost */
    struct frame_reader reader;
    uint64_t busy_ms; /* what is sent to it arrives no sooner */
};

struct net_link {
    struct net_end end[2];
};

struct net {
    uint64_t seed, random;
    uint64_t now_ms;
    unsigned most_delay_ms;
    bool verbose;
    struct events events;
    struct net_link **links;
    size_t nlinks, cap_links;
    uint64_t next_conn;
    const struct node_ops *ops[NET_NODES]; /* by node; NULL: not there */
    /* Called before a message is heard, and after; NULL: nobody cares. */
    void (*hear)(struct net *net, int from, int to, const struct msg *m,
                 bool after);
    /* Tells on stderr what state all is in, when a seed fails; NULL: nobody. */
    void (*describe)(const struct net *net);
    unsigned offers[64]; /* by node: the highest version of the protocol */
    bool repeats;        /* messages that may come twice sometimes do */
    unsigned repeated;
    struct msg msg;
};

#define SIM_CHECK(net, cond)                                                   \
    do {                                                                       \
        if (!(cond))                                                           \
            net_fail(net, __FILE__, __LINE__, #cond);                          \
    } while (0)

_Noreturn void net_fail(const struct net *net, const char *file, int line,
                        const char *what);

void net_init(struct net *net, uint64_t seed);
void net_release(struct net *net);

/* Uniform in [0, n). */
unsigned net_random(struct net *net, unsigned n);
/* True once in n times. */
bool net_chance(struct net *net, unsigned n);
void net_bytes(void *net, void *buf, size_t n);

/* Have fn called with the net after that delay; what is returned may be filled
 * in until the next event is made. */
struct event *net_later(struct net *net, unsigned delay_ms,
                        void (*fn)(void *net, struct event *e));

/* Deal with the next event; false: there is none. */
bool net_step(struct net *net);

/* Join two nodes; either number may be 0: one is made up. */
struct net_link *net_join(struct net *net, int a, uint64_t a_conn, int b,
                          uint64_t b_conn, enum msg_session a_session,
                          enum msg_session b_session);

/* The open end of a node; NULL if it is not open. */
struct net_end *net_find(struct net *net, int node, uint64_t conn);

/* Send bytes, or a message, from a node's open end.  */
void net_send(struct net *net, int node, uint64_t conn, const uint8_t *bytes,
              size_t len);
void net_send_msg(struct net *net, int node, uint64_t conn,
                  const struct msg *m);
void net_session(struct net *net, int node, uint64_t conn,
                 enum msg_session session, unsigned version);

/* Close from this side; the other hears of it after what was sent. */
void net_close(struct net *net, int node, uint64_t conn);
/* One link of a node, any, to one of nodes [first, last] breaks: nothing that
 * is under way comes, each side hears of it some time.  Returns how many. */
unsigned net_cut(struct net *net, int node, int first, int last);
/* What is sent to a node from now on, or by it, or both, arrives no sooner than
 * in so long: it is cut off, and nobody hears of that. */
void net_hold(struct net *net, int node, unsigned ms, bool to, bool from);
/* All ends of a node: it died. */
void net_close_all(struct net *net, int node);

#endif
