/* radd_conf.c - see radd_conf.h */
#include "config.h"

#include "radd/radd_conf.h"

#include "net/address.h"
#include "net/key/key.h"
#include "radd/hours.h"

#include <string.h>

#define MAX_THREADS 1024

#define FIELD(f) offsetof(struct radd_settings, f)
static const struct conf_key keys[] = {
    { "coordinator", CONF_TEXT_KEY, FIELD(coordinator), 0, 0,
      "/run/radd/radcoord.sock", "HOST:PORT|PATH", "whom to work for", false },
    { "key", CONF_TEXT_KEY, FIELD(key), 0, 0, "", "FILE",
      "this host's key, for a coordinator over the network", false },
    { "name", CONF_TEXT_KEY, FIELD(name), 0, 0, "", "NAME",
      "of this worker, unlike all others (its key's, or the host's name)",
      false },
    { "listen", CONF_TEXT_KEY, FIELD(listen), 0, 0, "127.0.0.1:" RADD_PORT,
      "ADDR:PORT|PATH", "where other workers dial", false },
    { "cache", CONF_TEXT_KEY, FIELD(cache), 0, 0, "/var/cache/radd", "DIR",
      "folder of the scenes' files", false },
    { "cache_mib", CONF_INT_KEY, FIELD(cache_mib), 0, 1 << 30, "0", "N",
      "most that these take [MiB]; 0: a tenth of the disk", true },
    { "threads", CONF_INT_KEY, FIELD(threads), 0, MAX_THREADS, "0", "N",
      "that render; 0: one a processor", false },
    { "memory_mib", CONF_INT_KEY, FIELD(memory_mib), 0, 1 << 24, "0", "N",
      "most memory of a job's process [MiB]; 0: no limit", true },
    { "nice", CONF_INT_KEY, FIELD(nice), 0, 19, "19", "N",
      "how much a job's process gives way to others", true },
    { "pixel_s", CONF_INT_KEY, FIELD(pixel_s), 0, 1 << 24, "600", "N",
      "most processor time of a pixel [s]; 0: no limit", true },
    { "load_s", CONF_INT_KEY, FIELD(load_s), 1, 1 << 20, "3600", "N",
      "longest that a job's process may load, or say nothing [s]", true },
    { "hours", CONF_TEXT_KEY, FIELD(hours), 0, 0, "", "TIMES",
      "when to work, as 'mon-fri 19:00-07:00, sat, sun' (always)", true },
    { "idle_only", CONF_BOOL_KEY, FIELD(idle_only), 0, 0, "no", "yes|no",
      "work only while nobody uses the machine", true },
    { "sandbox", CONF_TEXT_KEY, FIELD(sandbox), 0, 0, "auto", "auto|required",
      "required: render nothing where the kernel has no seccomp", false },
    { "launched", CONF_BOOL_KEY, FIELD(launched), 0, 0, "no", NULL, NULL,
      false },
    DAEMON_KEYS,
};

static int
check_text(const char *name, const char *value, struct rad_error *err)
{
    char host[ADDRESS_TEXT], port[8];
    struct hours hours;
    bool local;

    if (strcmp(name, "name") == 0 && strlen(value) > MSG_MAX_NAME)
        return rad_fail(err, RAD_ECONFIG, "longer than %d bytes", MSG_MAX_NAME);
    if (strcmp(name, "name") == 0 && value[0] &&
        !key_name_valid(value, strlen(value)))
        return rad_fail(err, RAD_ECONFIG,
                        "'%s': a worker's name needs letters, digits, '.', '_' "
                        "or '-'",
                        value);
    if (strcmp(name, "sandbox") == 0 && strcmp(value, "auto") != 0 &&
        strcmp(value, "required") != 0)
        return rad_fail(err, RAD_ECONFIG, "expected auto or required, got '%s'",
                        value);
    if (strcmp(name, "hours") == 0)
        return hours_parse(value, &hours, err);
    if (strcmp(name, "coordinator") == 0 && value[0])
        return address_split(value, host, port, &local, err);
    if (strcmp(name, "listen") == 0 && value[0])
        return address_split(value, host, port, &local, err);
    return daemon_check_text(name, value, err);
}

static int
check_settings(const void *settings, struct rad_error *err)
{
    const struct radd_settings *s = settings;

    if (s->idle_only && s->nice == 0)
        return rad_fail(err, RAD_EUSAGE,
                        "idle_only needs nice above 0: what gives way is told "
                        "from what others use by that");
    if (!s->listen[0] || !s->coordinator[0])
        return rad_fail(err, RAD_EUSAGE, "'%s' is not set",
                        s->listen[0] ? "coordinator" : "listen");
    return 0;
}

const struct conf_table radd_table = {
    .program = "radd",
    .synopsis = "[--coordinator=HOST:PORT|PATH] [--threads=N] ...",
    .about = "Render on this machine for a cluster, see radd(8); it stays in "
             "the foreground.",
    .file = SYSCONFDIR "/radd/radd.conf",
    .private_key = "embedded",
    .keys = keys,
    .size = sizeof(struct radd_settings),
    .check_text = check_text,
    .check = check_settings,
};
