/* hook.c - see hook.h */
#include "config.h"

#include "tests/tools/hook.h"

#include <stdio.h>
#include <stdlib.h>

static void
loop(void)
{
    for (;;)
        ;
}

void
test_hook_pixel(const struct rad_scene *scene, int x, int y)
{
    for (int32_t i = 0; i < scene->nobjects; i++) {
        const char *name = scene->objects[i].name;
        int at_x, at_y;

        if (sscanf(name, "test-crash-%d-%d", &at_x, &at_y) == 2 && at_x == x &&
            at_y == y)
            abort();
        if (sscanf(name, "test-loop-%d-%d", &at_x, &at_y) == 2 && at_x == x &&
            at_y == y)
            loop();
    }
}
