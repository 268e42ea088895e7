/* radcoord_conf.c - settings of the coordinator daemon; see radcoord_impl.h */
#include "config.h"

#include "radcoord/radcoord_impl.h"

#include "net/address.h"

#include <string.h>
#include <sys/statvfs.h>

/* --- settings --- */

#define FIELD(f) offsetof(struct radcoord_settings, f)
static const struct conf_key keys[] = {
    { "listen", CONF_TEXT_KEY, FIELD(listen), 0, 0, RADCOORD_LISTEN,
      "ADDR:PORT", "where workers and users dial; empty: nowhere", false },
    { "socket", CONF_TEXT_KEY, FIELD(socket), 0, 0, RADCOORD_SOCKET, "PATH",
      "Unix socket of this machine's users; empty: none", false },
    { "state", CONF_TEXT_KEY, FIELD(state), 0, 0, "/var/lib/radd", "DIR",
      "folder of jobs, scenes, rows and pictures", false },
    { "keep_jobs", CONF_INT_KEY, FIELD(keep_jobs), 10, 100000, "100", "N",
      "jobs of each user that are over and still kept", true },
    { "keep_days", CONF_INT_KEY, FIELD(keep_days), 0, 36500, "30", "N",
      "for so many days at most; 0: no limit", true },
    { "keep_mib", CONF_INT_KEY, FIELD(keep_mib), 0, 1 << 30, "0", "N",
      "with so many MiB of a user's pictures; 0: no limit", true },
    { "keep_caches_mib", CONF_INT_KEY, FIELD(keep_caches_mib), 0, 1 << 30,
      "2048", "N", "MiB of all users' ambient caches that are kept; 0: none",
      true },
    { "keep_unfetched_days", CONF_INT_KEY, FIELD(keep_unfetched_days), 0, 36500,
      "14", "N", "what its user has not fetched is kept, whatever else", true },
    { "user_unfetched", CONF_INT_KEY, FIELD(user_unfetched), 1, 100000, "1000",
      "N", "most jobs whose pictures a user has not fetched", true },
    { "lease_floor_s", CONF_INT_KEY, FIELD(lease_floor_s), 1, 1 << 20, "60",
      "N", "a unit that is out for less is not late [s]", true },
    { "user_jobs", CONF_INT_KEY, FIELD(user_jobs), 1, 10000, "1000", "N",
      "most jobs of a user that are not over", true },
    { "user_frames", CONF_INT_KEY, FIELD(user_frames), 1, 1 << 30, "200000",
      "N", "most frames of these", true },
    { "user_mib", CONF_INT_KEY, FIELD(user_mib), 0, 1 << 30, "0", "N",
      "most MiB on the disk for a user; 0: half of the disk", true },
    { "user_uploads", CONF_INT_KEY, FIELD(user_uploads), 2, 10000, "200", "N",
      "most scenes and files that a user sends at once", true },
    { "user_upload_mib", CONF_INT_KEY, FIELD(user_upload_mib), 0, 1 << 30, "0",
      "N", "most MiB of these before a job names them; 0: a tenth", true },
    { "user_connections", CONF_INT_KEY, FIELD(user_connections), 1, 10000,
      "256", "N", "most connections of a user", true },
    { "user_answers", CONF_INT_KEY, FIELD(user_answers), 1, 100000, "1000", "N",
      "most answers that a user waits for", true },
    { "user_unread_mib", CONF_INT_KEY, FIELD(user_unread_mib), 1, 65536, "32",
      "N", "with so many MiB of answers unread a user waits", true },
    { "upload_s", CONF_INT_KEY, FIELD(upload_s), 1, 365 * 86400, "3600", "N",
      "files and jobs whose scene does not come whole go then [s]", true },
    { "keys", CONF_TEXT_KEY, FIELD(keys), 0, 0, "", "FILE",
      "keys of who may come over the network; empty: nobody", false },
    { "logins", CONF_TEXT_KEY, FIELD(logins), 0, 0, "", "KEY=LOGIN,...",
      "whose key of another name is which login's; KEY=-: nobody's", true },
    DAEMON_KEYS,
};

/* Check the path of the Unix socket; a value without a slash names a file in
 * the current folder. */
static int
check_socket(const char *value, struct rad_error *err)
{
    char path[CONF_TEXT + 2], host[ADDRESS_TEXT], port[8];
    bool local;

    snprintf(path, sizeof path, "%s%s", strchr(value, '/') ? "" : "./", value);
    return address_split(path, host, port, &local, err);
}

static int
check_text(const char *name, const char *value, struct rad_error *err)
{
    char host[ADDRESS_TEXT], port[8];
    bool local;

    if (strcmp(name, "logins") == 0)
        return owners_check_map(value, err);
    if (strcmp(name, "socket") == 0)
        return value[0] ? check_socket(value, err) : 0;
    if (strcmp(name, "listen") != 0 || !value[0])
        return daemon_check_text(name, value, err);
    if (strchr(value, '/')) /* only a Unix socket tells the peer's uid */
        return rad_fail(err, RAD_ECONFIG,
                        "expected ADDR:PORT, got '%s': a path is for 'socket'",
                        value);
    return address_split(value, host, port, &local, err);
}

static int
check_settings(const void *settings, struct rad_error *err)
{
    const struct radcoord_settings *s = settings;

    if (!s->listen[0] && !s->socket[0])
        return rad_fail(err, RAD_EUSAGE, "neither 'listen' nor 'socket' set");
    return 0;
}

const struct conf_table radcoord_table = {
    .program = "radcoord",
    .synopsis = "[--listen=ADDR:PORT] [--socket=PATH] [--keys=FILE] ...",
    .about = "Coordinate a cluster that renders Radiance scenes, see "
             "radcoord(8); it stays in\nthe foreground.",
    .file = SYSCONFDIR "/radd/radcoord.conf",
    .private_key = "embedded",
    .keys = keys,
    .size = sizeof(struct radcoord_settings),
    .check_text = check_text,
    .check = check_settings,
};

/* --- settings passed to the machine --- */

static void
set_keep(struct radcoord *r)
{
    struct coord_keep keep = {
        .jobs = (uint32_t)r->set.keep_jobs,
        .ms = (uint64_t)r->set.keep_days * 24 * 3600 * 1000,
        .bytes = (uint64_t)r->set.keep_mib << 20,
        .cache_bytes = (uint64_t)r->set.keep_caches_mib << 20,
        .unfetched_ms = (uint64_t)r->set.keep_unfetched_days * 24 * 3600 * 1000,
    };

    coord_set_keep(r->coord, &keep);
}

/* Size of the disk that holds the state folder [bytes]. */
static uint64_t
disk_bytes(const struct radcoord *r)
{
    struct statvfs st;

    if (statvfs(r->set.state, &st) < 0)
        return 0;
    return (uint64_t)st.f_frsize * st.f_blocks;
}

/* A limit [bytes]: the setting or, if that is 0, 1/part of the disk but at
 * least 1 GiB. */
static uint64_t
share(int set_mib, uint64_t disk, unsigned part)
{
    if (set_mib > 0)
        return (uint64_t)set_mib << 20;
    return disk / part > 1u << 30 ? disk / part : 1u << 30;
}

static void
set_limits(struct radcoord *r)
{
    const struct radcoord_settings *s = &r->set;
    uint64_t disk = disk_bytes(r);
    struct coord_limits l = {
        .jobs = (uint64_t)s->user_jobs,
        .frames = (uint64_t)s->user_frames,
        .bytes = share(s->user_mib, disk, 2),
        .uploads = (uint64_t)s->user_uploads,
        .upload_bytes = share(s->user_upload_mib, disk, 10),
        .conns = (uint64_t)s->user_connections,
        .answers = (uint64_t)s->user_answers,
        .unfetched = (uint64_t)s->user_unfetched,
        .unread = (uint64_t)s->user_unread_mib << 20,
        .upload_ms = UINT64_C(1000) * (unsigned)s->upload_s,
    };

    coord_set_limits(r->coord, &l);
    fair_set_unread(&r->fair, (size_t)l.unread);
}

void
radcoord_apply(struct radcoord *r)
{
    set_keep(r);
    coord_set_lease_floor(r->coord,
                          UINT64_C(1000) * (unsigned)r->set.lease_floor_s);
    set_limits(r);
}
