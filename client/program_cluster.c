/* program_cluster.c - the cluster that renders the job; see program_cluster.h
 */
#include "config.h"

#include "program_cluster.h"

#include "link/launch.h"
#include "link/local.h"
#include "program_say.h"

#include <stdio.h>

int
program_cluster_workers(const struct submit_options *o)
{
    return o->workers ? o->workers : 1;
}

int
program_cluster_choose(struct program *p)
{
    int rc = 0;

    if (!p->o.local && !p->o.launch)
        rc =
            target_find(&p->cluster.target, p->o.coordinator, p->o.key, p->err);
    if (rc < 0)
        return rc;
    p->cluster.embedded = rc == 0;
    if (p->cluster.embedded && p->o.detach)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--detach needs a coordinator: a cluster of "
                        "radsubmit's own ends with it");
    if (p->cluster.embedded && p->o.job)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--job needs a coordinator, which has it");
    if (p->cluster.embedded && p->o.reuse)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--reuse needs a coordinator: a cluster of "
                        "radsubmit's own keeps nothing");
    if (!p->cluster.embedded && (p->o.workers || p->o.threads))
        return rad_fail(p->err, RAD_EUSAGE,
                        "--workers and --threads are for a cluster of "
                        "radsubmit's own: use --local or --launch with "
                        "them");
    return 0;
}

int
program_cluster_start(struct program *p)
{
    struct launch_order order = { .command = p->o.launch,
                                  .address = p->o.address,
                                  .workers = program_cluster_workers(&p->o),
                                  .threads = p->o.threads,
                                  .wait_s = p->o.wait_s };
    struct link_where where = { &p->loop.uv, &p->loop.interrupts };
    int rc = p->o.launch ? launch_start(&p->cluster.launch, p->cluster.local,
                                        &order, &where, p->err)
                         : local_start(p->cluster.local, order.workers,
                                       order.threads, &where, p->err);

    uv_update_time(&p->loop.uv);
    p->cluster.began_ms = uv_now(&p->loop.uv);
    if (rc == 0) {
        local_share(p->cluster.local, &p->cargo);
        p->cluster.target = *local_target(p->cluster.local);
    }
    return rc;
}

int
program_cluster_alive(void *arg, struct rad_error *err)
{
    struct program *p = arg;

    return p->cluster.launch ? launch_alive(p->cluster.launch, err)
                             : local_alive(p->cluster.local, err);
}

/* Those of --local will be there soon. */
int
program_cluster_gathered(void *arg, int n, const char *names,
                         struct rad_error *err)
{
    struct program *p = arg;
    char text[500], of[24];
    bool news;
    int rc;

    if (!p->cluster.launch)
        return n >= local_workers(p->cluster.local) ||
               (double)(uv_now(&p->loop.uv) - p->cluster.began_ms) >=
                   1000 * p->o.wait_s;
    rc = launch_gathered(p->cluster.launch, n, names, &news, err);
    snprintf(of, sizeof of, " of %d", program_cluster_workers(&p->o));
    snprintf(text, sizeof text, "%d%s workers there%s%s", n,
             n > program_cluster_workers(&p->o) ? "" : of, n > 0 ? ": " : "",
             names);
    if (news)
        program_news(p, text);
    return rc;
}
