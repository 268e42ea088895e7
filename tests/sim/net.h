/* net.h - a network in virtual time, under a seed
 *
 * Nodes are joined by links, which carry bytes both ways.  Each direction of a
 * link keeps its order, as TCP does; different links overtake each other.
 * Bytes arrive in pieces and go through the real frame reader.
 *
 * SIM_CHECK that fails prints the seed and ends the program. */
#ifndef SIM_NET_H
#define SIM_NET_H

#include "proto/frame.h"
#include "event.h"

struct net;

enum { NET_NODES = 128 };

/* Callbacks of a kind of node. */
struct node_ops {
    void (*message)(struct net *net, int node, uint64_t conn,
                    const struct msg *m);
    void (*closed)(struct net *net, int node, uint64_t conn);
};

struct net_end {
    int node;
    uint64_t conn;
    bool open;
    bool deaf; /* the link is cut, and bytes under way are lost */
    struct frame_reader reader;
    uint64_t busy_ms; /* bytes that are sent to it arrive no sooner */
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
    const struct node_ops *ops[NET_NODES]; /* by node; NULL: the node is dead */
    /* Called before a message is heard, and after; may be NULL. */
    void (*hear)(struct net *net, int from, int to, const struct msg *m,
                 bool after);
    /* Prints the states of all on stderr when a check fails; may be NULL. */
    void (*describe)(const struct net *net);
    unsigned offers[64]; /* by node: highest version that it speaks */
    bool repeats;        /* some messages are sent twice */
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

/* Have fn called after that delay.  The returned event may be changed until the
 * next one is made. */
struct event *net_later(struct net *net, unsigned delay_ms,
                        void (*fn)(void *net, struct event *e));

/* Handle the next event; false: there is none. */
bool net_step(struct net *net);

/* Join two nodes by a link.  A connection number of 0 stands for a new one. */
struct net_link *net_join(struct net *net, int a, uint64_t a_conn, int b,
                          uint64_t b_conn, enum msg_session a_session,
                          enum msg_session b_session);

/* The open end of a node's connection; NULL: it is closed. */
struct net_end *net_find(struct net *net, int node, uint64_t conn);

/* Send bytes, or a message, from a node's open end. */
void net_send(struct net *net, int node, uint64_t conn, const uint8_t *bytes,
              size_t len);
void net_send_msg(struct net *net, int node, uint64_t conn,
                  const struct msg *m);
void net_session(struct net *net, int node, uint64_t conn,
                 enum msg_session session, unsigned version);

/* Close this side's end; the other side hears of it after all bytes sent
 * before. */
void net_close(struct net *net, int node, uint64_t conn);
/* Cut one link, at random, between a node and one of the nodes [first, last]:
 * all that is under way is lost, and both sides hear of the end some time
 * later.  Returns the number of links that were cut. */
unsigned net_cut(struct net *net, int node, int first, int last);
/* Hold up bytes to a node, from it, or both for ms from now on; nobody is told.
 */
void net_hold(struct net *net, int node, unsigned ms, bool to, bool from);
/* Close all ends of a node that died. */
void net_close_all(struct net *net, int node);

#endif
