/* counted.c - see counted.h */
#include "config.h"

#include "machine/counted.h"

_Static_assert(RAD_MAX_FAULTS == MSG_FAULTS, "one for each");

static void
add_faults(struct msg_fault to[MSG_FAULTS],
           const struct rad_fault from[RAD_MAX_FAULTS])
{
    struct msg_fault more[MSG_FAULTS];

    for (int i = 0; i < MSG_FAULTS; i++)
        more[i] = (struct msg_fault){ (uint32_t)from[i].object, from[i].count };
    msg_faults_add(to, more);
}

void
counted_add(struct msg_counts *sum, const struct rad_counts *c, double cpu_s)
{
    struct msg_nan nan = { c->nan_pixels, 0, (uint32_t)c->nan_x,
                           (uint32_t)c->nan_y };

    sum->rays += c->rays;
    sum->primary_rays += c->primary_rays;
    sum->shadow_rays += c->shadow_rays;
    sum->ambient_rays += c->ambient_rays;
    sum->paint_rays += c->paint_rays;
    sum->intersection_tests += c->geom.tests;
    sum->ambient_values += c->ambient_values;
    msg_nan_add(&sum->nan, &nan);
    add_faults(sum->faults, c->faults);
    sum->cpu_s += cpu_s;
}
