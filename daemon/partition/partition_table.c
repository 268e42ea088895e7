/* partition_table.c - the table of units, and the stack of units that came
 * back */
#include "config.h"

#include "partition/partition_impl.h"

#include "base/list.h"

#include <string.h>

uint32_t
partition_add(struct partition *p, const struct partition_area *area)
{
    struct partition_unit *u;

    if (!rad_list_grow(&p->unit, p->total, sizeof *u))
        return PARTITION_NONE;
    u = &p->unit[p->total];
    memset(u, 0, sizeof *u);
    u->area = *area;
    u->keeper = PARTITION_NONE;
    p->waiting++;
    p->undone++;
    return p->total++;
}

bool
partition_back(struct partition *p, uint32_t unit)
{
    if (!rad_list_grow(&p->back, p->nback, sizeof *p->back))
        return false;
    p->back[p->nback++] = unit;
    return true;
}
