/* feeding.c - see feeding.h */
#include "config.h"

#include "desk/feeding.h"

#include "desk/linking.h"

/* Workers that the coordinator feeds.  Few, for the coordinator sends each of
 * them the records of all tiles, and tiles to be made wait behind these records
 * on the connection. */
#define DIRECT 2
/* Workers that a worker feeds.  With 2 a record reaches the last worker
 * soonest, if the machines' network is the limit. */
#define FED 2
_Static_assert(FED <= MSG_MOST_FED, "names in FEED");

bool
feeding_is_direct(const struct job *job, uint32_t index)
{
    return desk_is_ready(job, index) && job->parts[index].feeder == 0;
}

/* The number of links on the way from the coordinator to the worker; 0: the way
 * goes by worker not_by. */
static uint32_t
depth(const struct job *job, uint32_t index, uint32_t not_by)
{
    uint32_t n = 1;

    for (; index != not_by && job->parts[index].feeder > 0; n++)
        index = job->parts[index].feeder - 1;
    return index == not_by ? 0 : n;
}

static uint32_t
count_fed(const struct job *job, uint32_t feeder)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nparts; i++)
        n += desk_is_ready(job, i) && job->parts[i].feeder == feeder;
    return n;
}

/* The number of other workers that the coordinator feeds and that have no more
 * failures than this worker.  A worker with more may hang, and does not count.
 */
static uint32_t
count_direct(const struct job *job, uint32_t index)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nparts; i++)
        n += i != index && feeding_is_direct(job, i) &&
             job->parts[i].failures <= job->parts[index].failures;
    return n;
}

/* The feeder for this worker, as index + 1; 0: the coordinator.  Of the ready
 * workers that can be linked with it and feed fewer than FED, the worker with
 * the fewest failures and then the fewest links to the coordinator. */
static uint32_t
choose_feeder(const struct coord *c, const struct job *job, uint32_t index)
{
    uint64_t least = UINT64_MAX;
    uint32_t best = 0, n;

    if (count_direct(job, index) < (c->env.direct > 0 ? c->env.direct : DIRECT))
        return 0;
    for (uint32_t i = 0; i < job->nparts; i++) {
        uint64_t k = (uint64_t)job->parts[i].failures << 32;

        if (desk_is_ready(job, i) && (n = depth(job, i, index)) > 0 &&
            k + n < least && count_fed(job, i + 1) < FED &&
            linking_can(job->parts[i].worker, job->parts[index].worker)) {
            best = i + 1;
            least = k + n;
        }
    }
    return best;
}

/* Send FEED: tell a feeder which workers it feeds. */
static void
send_feed(struct coord *c, const struct job *job, uint32_t feeder)
{
    struct msg m = { .type = MSG_FEED, .feed = { .job = job->id } };

    if (feeder == 0 || !desk_is_ready(job, feeder - 1))
        return;
    for (uint32_t i = 0; i < job->nparts; i++)
        if (desk_is_ready(job, i) && job->parts[i].feeder == feeder &&
            m.feed.n < MSG_MOST_FED)
            m.feed.name[m.feed.n++] = job->parts[i].name;
    actions_send(&c->actions, job->parts[feeder - 1].worker->conn, &m);
}

static void
assign_feeder(struct coord *c, struct job *job, uint32_t index)
{
    uint32_t feeder = choose_feeder(c, job, index);

    job->parts[index].feeder = feeder;
    if (feeder == 0)
        return;
    linking_need(c, job, feeder - 1, index);
    send_feed(c, job, feeder);
}

/* Give a worker another feeder.  That feeder is not to blame for records of
 * open passes that went past it before now. */
static void
change_feeder(struct coord *c, struct job *job, uint32_t index)
{
    assign_feeder(c, job, index);
    job->parts[index].excused = MSG_OPEN_PASSES + 1;
}

void
feeding_join(struct coord *c, struct job *job, uint32_t index)
{
    struct job_part *part = &job->parts[index];

    part->feeder = part->failures = part->excused = 0;
    part->missed = false;
    if (job->passes)
        assign_feeder(c, job, index);
}

void
feeding_left(struct coord *c, struct job *job, uint32_t index)
{
    uint32_t feeder = job->parts[index].feeder;

    job->parts[index].feeder = 0;
    if (!job->passes)
        return;
    send_feed(c, job, feeder);
    for (uint32_t i = 0; i < job->nparts; i++)
        if (job->parts[i].feeder == index + 1)
            change_feeder(c, job, i);
}

void
feeding_lacked(struct job *job, uint32_t index)
{
    job->parts[index].missed = true;
}

/* Did the worker's feeder fail to pass records on?  A feeder that missed
 * records itself had none to pass on. */
static bool
is_failed(const struct job *job, const struct job_part *part)
{
    return part->missed && part->excused == 0 && part->feeder > 0 &&
           !job->parts[part->feeder - 1].missed;
}

void
feeding_mend(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++) {
        uint32_t feeder = job->parts[i].feeder;

        if (!desk_is_ready(job, i) || !is_failed(job, &job->parts[i]))
            continue;
        job->parts[feeder - 1].failures++;
        change_feeder(c, job, i);
        send_feed(c, job, feeder);
    }
    for (uint32_t i = 0; i < job->nparts; i++) {
        struct job_part *part = &job->parts[i];

        if (feeding_is_direct(job, i)) /* another may have fewer failures */
            change_feeder(c, job, i);
        part->excused -= part->excused > 0;
        part->missed = false;
    }
}
