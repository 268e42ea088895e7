/* counts.c - sums of what units cost
 *
 * Of pixels that are no numbers a sum names the first one in the picture, and
 * of faults the first few by object: so a sum does not depend on the order in
 * which units are added. */
#include "config.h"

#include "proto/message.h"

#include <string.h>

static bool
nan_before(const struct msg_nan *a, const struct msg_nan *b)
{
    if (a->frame != b->frame)
        return a->frame < b->frame;
    return a->y != b->y ? a->y < b->y : a->x < b->x;
}

void
msg_nan_add(struct msg_nan *a, const struct msg_nan *b)
{
    uint64_t sum = a->pixels + b->pixels;

    if (b->pixels > 0 && (a->pixels == 0 || nan_before(b, a)))
        *a = *b;
    a->pixels = sum;
}

static void
add_fault(struct msg_fault a[MSG_FAULTS], const struct msg_fault *b)
{
    int at = 0;

    while (at < MSG_FAULTS && a[at].count > 0 && a[at].object < b->object)
        at++;
    if (at == MSG_FAULTS)
        return;
    if (a[at].count == 0 || a[at].object != b->object) {
        memmove(a + at + 1, a + at, (size_t)(MSG_FAULTS - 1 - at) * sizeof *a);
        a[at] = (struct msg_fault){ b->object, 0 };
    }
    a[at].count += b->count;
}

void
msg_faults_add(struct msg_fault a[MSG_FAULTS],
               const struct msg_fault b[MSG_FAULTS])
{
    for (int i = 0; i < MSG_FAULTS; i++)
        if (b[i].count > 0)
            add_fault(a, &b[i]);
}

void
msg_doubt_add(struct msg_doubt *a, const struct msg_doubt *b)
{
    for (int i = 0; i < MSG_DOUBT_SUMS; i++)
        a->v[i] += b->v[i];
}

void
msg_rays_add(struct msg_counts *a, const struct msg_counts *b)
{
    a->rays += b->rays;
    a->primary_rays += b->primary_rays;
    a->speculative_rays += b->speculative_rays;
    a->shadow_rays += b->shadow_rays;
    a->ambient_rays += b->ambient_rays;
    a->paint_rays += b->paint_rays;
    a->estimate_rays += b->estimate_rays;
    a->intersection_tests += b->intersection_tests;
    a->ambient_values += b->ambient_values;
}

void
msg_counts_add(struct msg_counts *a, const struct msg_counts *b)
{
    msg_rays_add(a, b);
    msg_nan_add(&a->nan, &b->nan);
    msg_faults_add(a->faults, b->faults);
    a->cpu_s += b->cpu_s;
    a->wall_s += b->wall_s;
    msg_doubt_add(&a->doubt, &b->doubt);
}

static uint64_t
lack(uint64_t all, uint64_t have)
{
    return all > have ? all - have : 0;
}

static double
lack_of(double all, double have)
{
    return all > have ? all - have : 0;
}

void
msg_counts_lack(struct msg_counts *out, const struct msg_counts *all,
                const struct msg_counts *have)
{
    *out = (struct msg_counts){
        .rays = lack(all->rays, have->rays),
        .speculative_rays = lack(all->speculative_rays, have->speculative_rays),
        .shadow_rays = lack(all->shadow_rays, have->shadow_rays),
        .ambient_rays = lack(all->ambient_rays, have->ambient_rays),
        .paint_rays = lack(all->paint_rays, have->paint_rays),
        .estimate_rays = lack(all->estimate_rays, have->estimate_rays),
        .intersection_tests =
            lack(all->intersection_tests, have->intersection_tests),
        .ambient_values = lack(all->ambient_values, have->ambient_values),
        .cpu_s = lack_of(all->cpu_s, have->cpu_s)
    };
    for (int i = 0; i < MSG_DOUBT_SUMS; i++)
        out->doubt.v[i] = all->doubt.v[i] - have->doubt.v[i];
}
