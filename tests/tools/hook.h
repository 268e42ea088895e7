/* hook.h - a scene that brings the renderer down, for the tests
 *
 * In tests/tools/radd-hooked, which is radd with this compiled in and is never
 * installed, a modifier called test-crash-X-Y or test-loop-X-Y makes tracing
 * the pixel at column X and row Y crash, or never end. */
#ifndef RADD_TESTS_HOOK_H
#define RADD_TESTS_HOOK_H

#include "scene/scene.h"

void test_hook_pixel(const struct rad_scene *scene, int x, int y);

#endif
