/* rescue.c - see rescue.h */
#include "config.h"

#include "link/rescue.h"

#include "base/output.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef int write_fn(void *arg, const char *path, struct rad_error *err);

/* Returns the path; NULL: it could not be written there. */
static char *
write_in(const char *folder, const char *name, write_fn *write, void *arg)
{
    struct rad_error err = { 0 };
    char *path = malloc(strlen(folder) + strlen(name) + 2);

    if (!path)
        return NULL;
    sprintf(path, "%s/%s", folder, name);
    if (write(arg, path, &err) < 0) {
        free(path);
        return NULL;
    }
    return path;
}

char *
rescue_by(const uint8_t job[MSG_JOB], uint32_t frame, const char *ending,
          write_fn *write, void *arg)
{
    const char *const folders[] = { getenv("TMPDIR"), "/var/tmp", "/tmp" };
    char hex[MSG_JOB_HEX], name[MSG_JOB_HEX + 64], *path = NULL;

    msg_job_format(job, hex);
    snprintf(name, sizeof name, "radsubmit-%s-%" PRIu32 "%s", hex, frame,
             ending);
    for (size_t i = 0; i < sizeof folders / sizeof folders[0] && !path; i++)
        if (folders[i] && folders[i][0] == '/')
            path = write_in(folders[i], name, write, arg);
    return path;
}

struct bytes {
    const uint8_t *p;
    size_t n;
};

static int
write_bytes(void *arg, const char *path, struct rad_error *err)
{
    const struct bytes *b = arg;

    return rad_output_write(path, b->p, b->n, true, err);
}

char *
rescue_write(const uint8_t job[MSG_JOB], uint32_t frame, const char *ending,
             const uint8_t *bytes, size_t n)
{
    struct bytes b = { bytes, n };

    return rescue_by(job, frame, ending, write_bytes, &b);
}
