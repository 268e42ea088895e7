/* report.h - answers for programs: /api/v1/ in JSON, /metrics in OpenMetrics
 *
 * Rows are the coordinator's, with the members that `radctl --json` shows;
 * radweb(8) lists the members around these rows.
 * Thread: the loop's. */
#ifndef RADD_WEB_REPORT_H
#define RADD_WEB_REPORT_H

#include "observer/markup.h"
#include "observer/model.h"
#include "observer/watch.h"

/* Write the API's answers. */
void report_status(struct markup *m, const struct model *c);
void report_workers(struct markup *m, const struct model *c);
void report_jobs(struct markup *m, const struct model *c);
void report_history(struct markup *m, const struct model *c);
void report_job(struct markup *m, const struct watch *w);

/* radweb's own counters, for its metrics. */
struct report_served {
    uint64_t requests, refused;
    unsigned streams, guests;
    size_t answer_bytes; /* of all blobs */
};
/* Write the metrics. */
void report_metrics(struct markup *m, const struct model *c,
                    const struct report_served *s);

#endif
