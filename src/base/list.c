/* list.c - see list.h */
#include "config.h"

#include "base/list.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define FEWEST 16 /* elements; a power of two */

bool
rad_list_grow(void *list, size_t n, size_t size)
{
    size_t room = n < FEWEST ? FEWEST : 2 * n;
    void *v;

    memcpy(&v, list, sizeof v); /* whatever type the pointer has */
    if (n > 0 && (n < FEWEST || (n & (n - 1)) != 0))
        return true;
    if (n > SIZE_MAX / 2 / size || !(v = realloc(v, room * size)))
        return false;
    memcpy(list, &v, sizeof v);
    return true;
}
