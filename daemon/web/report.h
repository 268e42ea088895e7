/* report.h - what programs read: /api/v1/ in JSON, /metrics in OpenMetrics
 *
 * Rows are the coordinator's own, with the members that `radctl --json` shows;
 * radweb(8) lists what is around them.
 * Thread: the loop's. */
#ifndef RADD_WEB_REPORT_H
#define RADD_WEB_REPORT_H

#include "draw/markup.h"
#include "observer/model.h"
#include "observer/watch.h"

/* One of the API's answers. */
void report_status(struct markup *m, const struct model *c);
void report_workers(struct markup *m, const struct model *c);
void report_jobs(struct markup *m, const struct model *c);
void report_history(struct markup *m, const struct model *c);
void report_job(struct markup *m, const struct watch *w);

/* What radweb itself has done, for its own metrics. */
struct report_served {
    uint64_t requests, refused;
    unsigned streams, guests;
    size_t answer_bytes; /* that are kept */
};
void report_metrics(struct markup *m, const struct model *c,
                    const struct report_served *s);

#endif
