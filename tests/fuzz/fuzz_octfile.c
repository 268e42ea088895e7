/* fuzz_octfile.c - any bytes as an octree file, with its tree and without */
#include "config.h"

#include "scene/octfile.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

static int
load(const uint8_t *data, size_t size, struct rad_octree *tree)
{
    struct rad_memory_in from = { data, size };
    struct rad_stream in = rad_memory_stream(&from);
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };
    int rc = s ? rad_octfile_read(s, tree, &in, "fuzz.oct", &err) : 0;

    if (rc != err.code || (rc && !err.what[0]))
        abort();
    if (s && !rc)
        rad_scene_check(s, NULL, NULL, NULL);
    rad_scene_free(s);
    return rc;
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_octree tree;
    int rc = load(data, size, &tree);

    if (rad_octfile_names(data, size) && !rc)
        abort(); /* what names others holds nothing that is read here */

    if (!rc) {
        rad_octree_release(&tree);
        /* a tree that can be read can be skipped */
        if (load(data, size, NULL))
            abort();
    }
    return 0;
}
