/* partition_table.c - the table of units, and the stack of those that came
 * back */
#include "config.h"

#include "partition/partition_impl.h"

#include <stdlib.h>
#include <string.h>

uint32_t
partition_add(struct partition *p, const struct partition_area *area)
{
    struct partition_unit *u;

    if (p->total == p->cap) {
        uint32_t cap = p->cap ? 2 * p->cap : 64;

        u = realloc(p->unit, cap * sizeof *u);
        if (!u)
            return PARTITION_NONE;
        p->unit = u;
        p->cap = cap;
    }
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
    if (p->nback == p->cap_back) {
        uint32_t cap = p->cap_back ? 2 * p->cap_back : 64;
        uint32_t *v = realloc(p->back, cap * sizeof *v);

        if (!v)
            return false;
        p->back = v;
        p->cap_back = cap;
    }
    p->back[p->nback++] = unit;
    return true;
}
