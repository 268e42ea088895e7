/* fuzz_conf.c - any text as a daemon's configuration file
 *
 * What is taken is within its bounds, and its hours and addresses are texts
 * that can be looked at. */
#include "config.h"

#include "net/address.h"
#include "ground/conf.h"
#include "radd/hours.h"
#include "tests/fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct settings {
    char hours[CONF_TEXT], listen[CONF_TEXT];
    int threads;
    bool idle_only;
    int hidden;
};

#define FIELD(f) offsetof(struct settings, f)
static const struct conf_key keys[] = {
    { "hours", CONF_TEXT_KEY, FIELD(hours), 0, 0, "", "HOURS", "", true },
    { "listen", CONF_TEXT_KEY, FIELD(listen), 0, 0, "", "ADDRESS", "", false },
    { "threads", CONF_INT_KEY, FIELD(threads), -3, 64, "2", "N", "", false },
    { "idle_only", CONF_BOOL_KEY, FIELD(idle_only), 0, 0, "no", "", "", true },
    { "hidden", CONF_INT_KEY, FIELD(hidden), 0, 9, "0", NULL, NULL, false },
    { NULL, 0, 0, 0, 0, NULL, NULL, NULL, false },
};
static const struct conf_table table = {
    .program = "radd", .synopsis = "", .keys = keys,
    .size = sizeof(struct settings)
};

static void
look_at(const struct settings *s)
{
    char host[ADDRESS_TEXT], port[8];
    struct hours h;
    bool local;
    int open = 0;

    if (s->threads < -3 || s->threads > 64 || s->hidden != 0 ||
        !memchr(s->hours, '\0', CONF_TEXT) ||
        !memchr(s->listen, '\0', CONF_TEXT))
        abort();
    if (hours_parse(s->hours, &h, NULL) == 0) {
        for (int day = 0; day < 7; day++)
            for (int minute = 0; minute < 24 * 60; minute++)
                open += hours_open(&h, day, minute);
        if (s->hours[0] == '\0' && open != HOURS_MINUTES)
            abort();
    }
    if (address_split(s->listen, host, port, &local, NULL) == 0)
        address_is_wildcard(s->listen);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct settings s;
    char path[64];
    int fd = memfd_create("conf", MFD_CLOEXEC);

    if (fd < 0 || write(fd, data, size) != (ssize_t)size)
        abort();
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    conf_defaults(&table, &s);
    if (conf_read(&table, &s, path, NULL) == 0)
        look_at(&s);
    close(fd);
    return 0;
}
