/* views.c - see views.h */
#include "config.h"

#include "files/views.h"

#include "base/files.h"
#include "files/blobs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Is the file of frames one of the job's files?  Only these are kept as long as
 * the job, and sent to its workers. */
static bool
is_its_own(const struct msg_spec *spec)
{
    for (uint32_t i = 0; i < spec->files.n; i++)
        if (memcmp(spec->files.hash + (size_t)i * MSG_HASH, spec->views,
                   MSG_HASH) == 0)
            return true;
    return false;
}

int
views_read(struct views *v, const char *dir, struct msg_spec *spec,
           struct rad_error *err)
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
    struct rad_error why = { 0 };
    size_t len;

    if (spec->frames)
        return 0;
    if (!is_its_own(spec))
        return rad_fail(err, RAD_ENOINPUT,
                        "the list of frames is none of the job's files");
    rad_sha_to_hex(spec->views, name);
    snprintf(path, sizeof path, "%s/%s", dir, name);
    v->bytes = rad_file_read(path, MSG_MAX_VIEWS, &len, err);
    if (!v->bytes)
        return err->code;
    if (msg_views_unpack(&v->list, spec, v->bytes, len, &why) < 0)
        return rad_fail(err, why.code, "'%s': %s", path, why.what);
    return 0;
}

void
views_release(struct views *v)
{
    free(v->bytes);
    msg_release(&v->list);
    *v = (struct views){ 0 };
}
