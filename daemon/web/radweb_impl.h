/* radweb_impl.h - what the files of radweb share
 *
 * Private to:
 *   radweb.c       start and end
 *   radweb_conf.c  settings
 *   radweb_auth.c  may a request be answered: token, Host
 *   route.c        the answer of each path
 *   events.c       pages that stay open
 *   answer.c       headers that all answers have
 * They use session (requests to the coordinator), model and watch (its
 * answers), page and report (pages, JSON, metrics), serve (HTTP).
 * Thread: the loop's. */
#ifndef RADD_WEB_RADWEB_IMPL_H
#define RADD_WEB_RADWEB_IMPL_H

#include "ground/daemon.h"
#include "net/address.h"
#include "net/log.h"
#include "observer/model.h"
#include "observer/watch.h"
#include "web/report.h"
#include "web/serve.h"

#define RADWEB_TOKEN     1024 /* room for the longest token and its NUL */
#define RADWEB_MIN_TOKEN 16   /* length of the shortest token */
#define RADWEB_SHEETS    8    /* room for the sheets of route.c */

struct radweb_settings {
    struct daemon_settings common;
    char coordinator[CONF_TEXT];
    char key[CONF_TEXT];
    char listen[CONF_TEXT];
    char token_file[CONF_TEXT];
    char tls_cert[CONF_TEXT];
    char tls_key[CONF_TEXT];
    bool proxy;
};
extern const struct conf_table radweb_table;

/* A page or list of the cluster, made of the model as it was at that version.
 */
struct radweb_sheet {
    uint64_t version;
    struct blob *blob;
};

struct stream;
struct waiting;

struct radweb {
    struct radweb_settings set;
    struct daemon daemon;
    struct session *session;
    struct model model;
    struct watches watches;
    struct serve *serve;
    char token[RADWEB_TOKEN]; /* "": none, and only this machine is served */
    struct radweb_sheet sheets[RADWEB_SHEETS];
    struct radweb_sheet event; /* of the cluster's page */
    struct stream *streams;
    struct waiting *waiting; /* requests that wait for a job's data */
    const char *path;        /* of the request that is being handled */
    struct report_served served;
    struct log_limit refused;
    uint64_t sweep_ms;
    bool was_up, closing;
};

/* radweb_auth.c: read the token; then check that radweb may listen at its
 * address with the token and certificate that are set.  RAD_EPERM: it may not;
 * RAD_EUSAGE: a certificate without its key, or the reverse. */
int radweb_read_token(struct radweb *r, struct rad_error *err);
int radweb_check_listen(const struct radweb *r, struct rad_error *err);
/* Returns 0, or the HTTP status that refuses the request. */
unsigned radweb_refuses(struct radweb *r, struct MHD_Connection *c);

/* route.c: a serve_fn, and its end. */
enum MHD_Result route_request(void *arg, struct MHD_Connection *c,
                              const char *method, const char *path,
                              void **state);
void route_ended(void *arg, void *state);
/* Answer the waiting requests whose data have come or whose time is over; all:
 * answer all of them. */
void route_tick(struct radweb *r, bool all);
/* events.c: begin an event stream of a job, or of the cluster (w is NULL). */
enum MHD_Result events_begin(struct radweb *r, struct MHD_Connection *c,
                             struct watch *w);
/* The job (w), or the cluster (NULL), has changed. */
void events_wake(struct radweb *r, const struct watch *w);
/* Send a sign of life where it is due; while closing, end all streams. */
void events_tick(struct radweb *r);

#endif
