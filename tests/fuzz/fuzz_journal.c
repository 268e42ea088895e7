/* fuzz_journal.c - any bytes as a coordinator's database
 *
 * It is read as at the start of radcoord, and its jobs are taken up. */
#include "config.h"

#include "ground/disk.h"
#include "journal/journal.h"
#include "front/coord.h"
#include "registry/recover.h"
#include "steps.h"
#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool
no_row(void *arg, const uint8_t job[MSG_JOB], uint32_t frame, uint32_t y,
       uint8_t *pixels)
{
    (void)arg;
    (void)job;
    (void)frame;
    (void)y;
    pixels[0] = 0;
    return true;
}

static int
take(void *arg, const struct saved_job *s, struct rad_error *err)
{
    uint64_t pixels = 0;

    for (uint32_t i = 0; i < s->spec.nframes; i++)
        pixels += (uint64_t)s->spec.frames[i].width * s->spec.frames[i].height;
    if (pixels > 1000000) /* all right, but slow */
        return 0;
    steps_say(s->nunits > 0, "a job is taken up", s->spec.name);
    return recover_job(arg, 1000, s, no_row, NULL, err);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct coord_env env = { .program = "fuzz", .keeps = true };
    struct rad_error err = { 0 };
    struct coord *c = coord_new(&env);
    uint64_t date_ms = 1000, epoch;
    struct journal *j = NULL;
    char path[64];
    int fd;

    snprintf(path, sizeof path, "/tmp/fuzz_journal.%ld", (long)getpid());
    fd = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    if (fd < 0 || !c || disk_write_at(fd, data, size, 0, path, &err) < 0)
        abort();
    close(fd);
    if (journal_open(&j, path, JOURNAL_READ, &err) == 0 &&
        journal_check(j, &err) == 0 &&
        journal_begin_life(j, &date_ms, &epoch, &err) == 0)
        journal_read(j, take, c, &err);
    if (err.code != 0)
        steps_say(0, "is refused:", err.what);
    journal_close(j);
    unlink(path);
    snprintf(path, sizeof path, "/tmp/fuzz_journal.%ld-wal", (long)getpid());
    unlink(path);
    coord_free(c);
    return 0;
}
