/* check_sim.c - clusters under many seeds: whatever happens, every job ends,
 * and every pixel comes from the one result that counts
 *
 * RADD_SIM_SEED=n replays one seed and tells what happens; RADD_SIM_RUNS=n
 * tries that many. */
#include "config.h"

#include "cluster.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define RUNS 300

static json_int_t
number(const json_t *o, const char *name)
{
    return json_integer_value(json_object_get(o, name));
}

/* Every pixel of a unit is where it belongs, and all are of one attempt. */
static void
check_unit(struct sim *s, const struct sim_job *job, const json_t *unit)
{
    uint32_t f = (uint32_t)number(unit, "frame"); /* numbers are indices here */
    json_int_t x0 = number(unit, "x"), y0 = number(unit, "y");
    json_int_t w = number(unit, "width"), h = number(unit, "height");
    float attempt = job->picture[f][y0 * job->frame[f].width + x0].attempt;

    SIM_CHECK(&s->net,
              attempt >= 1 && attempt <= (float)number(unit, "attempts"));
    for (json_int_t y = y0; y < y0 + h; y++)
        for (json_int_t x = x0; x < x0 + w; x++) {
            struct sim_pixel *p = &job->picture[f][y * job->frame[f].width + x];

            SIM_CHECK(&s->net, p->x == (float)x && p->y == (float)y);
            SIM_CHECK(&s->net, p->attempt == attempt);
            p->attempt = -1; /* seen */
        }
}

static json_int_t
pixels(const struct sim_job *job)
{
    json_int_t n = 0;

    for (uint32_t f = 0; f < job->spec.nframes; f++)
        n += (json_int_t)job->frame[f].width * job->frame[f].height;
    return n;
}

static void
check_done(struct sim *s, const struct sim_job *job)
{
    json_t *root = json_loads(job->stats, 0, NULL), *units, *unit, *totals;
    json_int_t redone = 0, rays = 0;
    size_t i;

    SIM_CHECK(&s->net, root != NULL);
    units = json_object_get(root, "units");
    totals = json_object_get(root, "totals");
    json_array_foreach(units, i, unit)
    {
        check_unit(s, job, unit);
        redone += number(unit, "attempts") - 1;
        rays += number(unit, "rays");
    }
    for (uint32_t f = 0; f < job->spec.nframes; f++) {
        SIM_CHECK(&s->net, job->written[f]);
        for (uint32_t k = 0; k < job->frame[f].width * job->frame[f].height;
             k++)
            SIM_CHECK(&s->net, job->picture[f][k].attempt == -1);
    }
    /* a twin is an attempt, and nothing redone */
    SIM_CHECK(&s->net, number(totals, "units_redone") <= redone);
    SIM_CHECK(&s->net, number(totals, "rays") == rays);
    SIM_CHECK(&s->net, number(totals, "primary_rays") == pixels(job));
    json_decref(root);
}

static void
check_job(struct sim *s, const struct sim_job *job)
{
    if (job->poison != UINT32_MAX && !job->cancel) {
        SIM_CHECK(&s->net, job->failed && job->status == EX_SOFTWARE);
        SIM_CHECK(&s->net, strstr(job->text, "unit 0 ") != NULL);
    } else if (job->failed) {
        SIM_CHECK(&s->net, job->cancel || job->poison != UINT32_MAX);
    } else {
        SIM_CHECK(&s->net, job->done);
        check_done(s, job);
    }
}

/* What the clusters went through, summed. */
static struct {
    unsigned accidents, parked, gave, twins, estimates;
} sum;

static void
run(uint64_t seed, bool verbose)
{
    static struct sim s; /* large */

    sim_init(&s, seed);
    s.net.verbose = verbose;
    sim_run(&s);
    for (int i = 0; i < s.njobs; i++)
        check_job(&s, &s.job[i]);
    if (verbose)
        printf("seed %llu: %d workers, %d jobs, %u deaths, %u cuts, %u "
               "crashes, %llu ms\n",
               (unsigned long long)seed, s.nworkers, s.njobs, s.deaths, s.cuts,
               s.crashes, (unsigned long long)s.net.now_ms);
    sum.accidents += s.deaths + s.cuts + s.crashes;
    sum.parked += s.parked;
    sum.gave += s.gave;
    sum.twins += s.twins;
    sum.estimates += s.estimates;
    sim_release(&s);
}

int
main(void)
{
    const char *one = getenv("RADD_SIM_SEED"), *many = getenv("RADD_SIM_RUNS");
    uint64_t runs = many ? strtoull(many, NULL, 10) : RUNS;

    if (one) {
        run(strtoull(one, NULL, 10), true);
        return EXIT_SUCCESS;
    }
    for (uint64_t seed = 0; seed < runs; seed++)
        run(seed, false);
    printf(
        "%llu clusters, %u accidents, %u units parked, %u split, %u doubled, "
        "%u estimates: all jobs ended as they should\n",
        (unsigned long long)runs, sum.accidents, sum.parked, sum.gave,
        sum.twins, sum.estimates);
    return sum.accidents && sum.parked && sum.gave && sum.twins && sum.estimates
               ? EXIT_SUCCESS
               : EXIT_FAILURE;
}
