/* radweb_impl.h - the daemon radweb, as its own files see it
 *
 *   radweb.c       starts and ends it
 *   radweb_conf.c  settings
 *   radweb_auth.c  who may ask: token, Host
 *   route.c        what is at which path
 *   events.c       pages that stay open
 *   answer.c       headers that all answers have
 * Around them: session (the coordinator), model and watch (what it said), page,
 * chart and report (how that is shown), serve (HTTP).
 * Thread: the loop's. */
#ifndef RADD_WEB_RADWEB_IMPL_H
#define RADD_WEB_RADWEB_IMPL_H

#include "ground/daemon.h"
#include "net/log.h"
#include "observer/model.h"
#include "observer/watch.h"
#include "web/report.h"
#include "web/serve.h"

#define RADWEB_TOKEN     1024 /* longest, with its NUL */
#define RADWEB_MIN_TOKEN 16
#define RADWEB_SHEETS    8

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

/* A text as it was at that version of the model. */
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
    char token[RADWEB_TOKEN]; /* "": none is asked for */
    struct radweb_sheet sheets[RADWEB_SHEETS];
    struct radweb_sheet event; /* of the cluster's page */
    struct stream *streams;
    struct waiting *waiting; /* requests that are put off */
    struct report_served served;
    struct log_limit refused;
    uint64_t sweep_ms;
    bool was_up, closing;
};

/* radweb_auth.c: read the token, and see that where it listens is permitted
 * with what there is: RAD_EPERM, or RAD_EUSAGE for half a certificate. */
int radweb_read_token(struct radweb *r, struct rad_error *err);
int radweb_check_listen(const struct radweb *r, struct rad_error *err);
/* 0, or the HTTP status with which the request is refused. */
unsigned radweb_refuses(struct radweb *r, struct MHD_Connection *c);

/* route.c: a serve_fn, and its end. */
enum MHD_Result route_request(void *arg, struct MHD_Connection *c,
                              const char *method, const char *path,
                              void **state);
void route_ended(void *arg, void *state);
/* Go on with requests whose job has been asked about; all: with all. */
void route_tick(struct radweb *r, bool all);
/* events.c: begin a stream, of a job or (NULL) of the cluster. */
enum MHD_Result events_begin(struct radweb *r, struct MHD_Connection *c,
                             struct watch *w);
/* There is news, of that job or of the cluster. */
void events_wake(struct radweb *r, const struct watch *w);
/* Signs of life; closing: all end. */
void events_tick(struct radweb *r);

#endif
