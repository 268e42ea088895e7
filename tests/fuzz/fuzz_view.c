/* fuzz_view.c - view files; a view that can be set up can be used */
#include "config.h"

#include "picture/view.h"
#include "tests/fuzz/fuzz.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void
use(const struct rad_view *v)
{
    for (int i = 0; i < 9; i++) {
        double org[3], dir[3], pos[2], aspect = i & 1;
        int x = 640, y = 480;

        if (rad_view_ray(v, i % 3 * .5, i / 3 * .5, org, dir) >= 0)
            rad_view_locate(v, org, pos);
        rad_view_resolution(v, &aspect, &x, &y);
        if (x > 640 || y > 480 || x < 0 || y < 0)
            abort();
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_view v, w;
    struct rad_error err = { 0 };
    char line[RAD_VIEW_TEXT + 8] = "VIEW= ";

    rad_view_init(&v);
    rad_view_init(&w);
    if (rad_view_read(&v, (const char *)data, size, &err) < 0 ||
        rad_view_setup(&v, &err) < 0)
        return 0;
    use(&v);
    rad_view_format(&v, line + 6, sizeof line - 6);
    if (rad_view_line(&w, line, strlen(line), NULL) != 1 ||
        rad_view_setup(&w, NULL) < 0 || memcmp(&v, &w, sizeof v) != 0)
        abort();
    return 0;
}
