/* rescue.c - see rescue.h */
#include "config.h"

#include "link/rescue.h"

#include "base/output.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* NULL: it could not be written there. */
static char *
write_in(const char *folder, const char *name, const uint8_t *bytes, size_t n)
{
    struct rad_error err = { 0 };
    char *path = malloc(strlen(folder) + strlen(name) + 2);

    if (!path)
        return NULL;
    sprintf(path, "%s/%s", folder, name);
    if (rad_output_write(path, bytes, n, true, &err) < 0) {
        free(path);
        return NULL;
    }
    return path;
}

char *
rescue_write(const uint8_t job[MSG_JOB], uint32_t frame, const char *ending,
             const uint8_t *bytes, size_t n)
{
    const char *const folders[] = { getenv("TMPDIR"), "/var/tmp", "/tmp" };
    char hex[MSG_JOB_HEX], name[MSG_JOB_HEX + 64], *path = NULL;

    msg_job_format(job, hex);
    snprintf(name, sizeof name, "radsubmit-%s-%" PRIu32 "%s", hex, frame,
             ending);
    for (size_t i = 0; i < sizeof folders / sizeof folders[0] && !path; i++)
        if (folders[i] && folders[i][0] == '/')
            path = write_in(folders[i], name, bytes, n);
    return path;
}
