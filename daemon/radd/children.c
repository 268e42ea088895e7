/* children.c - see children.h */
#include "config.h"

#include "radd/children.h"

#include "net/log.h"
#include "child/render.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

extern char **environ;

/* A process that cannot be started now, because there are too many processes or
 * memory is short, is tried again every AGAIN_MS [ms], AGAIN_FOR times. */
#define AGAIN_MS  250
#define AGAIN_FOR 120

/* A child's process and its link, which end in any order:
 *
 *   WAITS --starts--> RUNS --link ends--> DIES
 *    | |               |                   |
 *    | | cannot start  | exits             | exits
 *    | '-----------> EXITED --link ends-> OVER
 *    '--------------link ends--------------^
 *
 * An ended link is one that broke, or that children_kill() closed. */
enum child_state {
    CHILD_WAITS, /* its process is yet to be started */
    CHILD_RUNS,
    CHILD_EXITED, /* or could not start; its link has still to be read */
    CHILD_DIES,   /* its process was killed, for the child has no link */
    CHILD_OVER    /* to be freed by settle() */
};

struct child {
    enum child_state state;
    uv_process_t *process; /* NULL: not started */
    uv_timer_t again;      /* runs until the process is started */
    int tries;
    int link; /* descriptor of the process's end, until that is started; or -1
               */
    unsigned memory_mib; /* 0: no limit */
    uint32_t own_mib;    /* the limit of its job; 0: none */
    struct child *next;
    struct children *all;
    uint64_t id;
    bool silent; /* ended() is not to be called */
    bool held;   /* its link is not read */
    struct child_end how;
    char text[160];
};

/* Make a path absolute, for a child runs in "/": so it keeps no folder in use,
 * and reads no name relative to our folder. */
static void
absolute(const char *path, char out[CHILDREN_PATH_MAX])
{
    size_t n = 0;

    if (path[0] != '/' && getcwd(out, CHILDREN_PATH_MAX))
        n = strlen(out);
    snprintf(out + n, CHILDREN_PATH_MAX - n, "%s%s", n > 0 ? "/" : "", path);
}

/* The variables that a child gets: those that the loader, the C library and
 * sanitizers read before main(), and those on which log lines depend.  The user
 * who started radd may have put secrets into other variables, and no scene may
 * read these. */
static const char *const passed_on[CHILDREN_MAX_ENV] = {
    "LD_LIBRARY_PATH", "LD_PRELOAD",     "GLIBC_TUNABLES",
    "ASAN_OPTIONS",    "LSAN_OPTIONS",   "TSAN_OPTIONS",
    "UBSAN_OPTIONS",   "JOURNAL_STREAM", "TZ",
};

void
children_environment(char *const *from, char *to[CHILDREN_MAX_ENV + 1])
{
    size_t n = 0;

    for (; *from; from++)
        for (size_t i = 0; i < CHILDREN_MAX_ENV && n < CHILDREN_MAX_ENV; i++) {
            size_t len = strlen(passed_on[i]);

            if (strncmp(*from, passed_on[i], len) == 0 && (*from)[len] == '=')
                to[n++] = *from;
        }
    to[n] = NULL;
}

void
children_init(struct children *all, struct shell *shell,
              const struct children_conf *conf, child_ended_fn *ended,
              void *arg)
{
    all->shell = shell;
    all->conf = *conf;
    absolute(conf->files_dir, all->files_dir);
    all->conf.files_dir = all->files_dir;
    all->ended = ended;
    all->arg = arg;
    all->list = NULL;
}

static void
free_handle(uv_handle_t *h)
{
    free(h);
}

static void
free_child(uv_handle_t *h)
{
    free(h->data);
}

static struct child *
find(struct children *all, uint64_t id)
{
    struct child *c = all->list;

    while (c && c->id != id)
        c = c->next;
    return c;
}

/* If the child is over, tell ended() and free it. */
static void
settle(struct child *c)
{
    struct children *all = c->all;
    struct child **at = &all->list;

    if (c->state != CHILD_OVER)
        return;
    while (*at != c)
        at = &(*at)->next;
    *at = c->next;
    if (!c->silent)
        all->ended(all->arg, c->id, c->how, c->text);
    if (c->process)
        uv_close((uv_handle_t *)c->process, free_handle);
    uv_close((uv_handle_t *)&c->again, free_child);
}

/* The process has exited, or will not start. */
static void
process_ended(struct child *c)
{
    c->state = c->state == CHILD_DIES ? CHILD_OVER : CHILD_EXITED;
}

/* The process has ended for want of memory, before it could tell. */
static void
blame_memory(struct child *c)
{
    snprintf(c->text, sizeof c->text, "out of memory");
    c->how.status = rad_exit_status(
        render_blame_limit(c->own_mib, c->memory_mib, c->text, sizeof c->text));
}

static void
on_exit_cb(uv_process_t *process, int64_t status, int signum)
{
    struct child *c = process->data;

    process_ended(c);
    if (!c->text[0])
        c->how = (struct child_end){ (int)status, signum };
    if (!c->text[0] && !signum && status == EX_OSERR)
        blame_memory(c);
    else if (!c->text[0] && signum)
        snprintf(c->text, sizeof c->text, "killed by signal %d%s", signum,
                 signum == SIGKILL ? ", perhaps for want of memory" : "");
    else if (!c->text[0])
        snprintf(c->text, sizeof c->text, "exit status %d", (int)status);
    settle(c);
}

/* The lower of two limits, where 0 means no limit. */
static unsigned
lower_limit(int radds, uint32_t jobs)
{
    if (radds <= 0 || jobs == 0)
        return radds > 0 ? (unsigned)radds : jobs;
    return (unsigned)radds < jobs ? (unsigned)radds : jobs;
}

static int
start(struct child *c)
{
    struct children *all = c->all;
    char threads[16], memory[16], nice[16], pixel[16], radd[16];
    char *args[] = { (char *)"radd",
                     (char *)RENDER_CHILD_OPTION,
                     (char *)all->conf.files_dir,
                     threads,
                     memory,
                     nice,
                     pixel,
                     (char *)(all->conf.sandboxed ? RENDER_SANDBOXED : ""),
                     radd,
                     NULL };
    uv_stdio_container_t fds[] = {
        { .flags = UV_IGNORE },
        { .flags = UV_INHERIT_FD, .data.fd = 2 },
        { .flags = UV_INHERIT_FD, .data.fd = 2 },
        { .flags = UV_INHERIT_FD, .data.fd = c->link },
    };
    char *env[CHILDREN_MAX_ENV + 1];
    uv_process_options_t o = { .exit_cb = on_exit_cb,
                               .file = "/proc/self/exe",
                               .args = args,
                               .env = env,
                               .cwd = "/",
                               .stdio = fds,
                               .stdio_count = RENDER_LINK_FD + 1 };

    snprintf(threads, sizeof threads, "%d", all->conf.threads);
    snprintf(memory, sizeof memory, "%u", c->memory_mib);
    snprintf(pixel, sizeof pixel, "%d", all->conf.pixel_s);
    snprintf(nice, sizeof nice, "%d", all->conf.nice);
    snprintf(radd, sizeof radd, "%d", (int)getpid());
    children_environment(environ, env);
    return uv_spawn(&all->shell->daemon->loop, c->process, &o);
}

static void
drop_link(struct child *c)
{
    if (c->link >= 0)
        close(c->link);
    c->link = -1;
}

static void
give_up(struct child *c, int rc)
{
    process_ended(c);
    c->how = (struct child_end){ EX_OSERR, 0 };
    snprintf(c->text, sizeof c->text, "cannot start: %s", uv_strerror(rc));
    drop_link(c); /* so our end of the link closes, which ends the child */
}

static bool
may_pass(int rc)
{
    return rc == UV_EAGAIN || rc == UV_ENOMEM || rc == UV_EMFILE ||
           rc == UV_ENFILE;
}

static void try_start(uv_timer_t *again);

/* Start the process, or set the timer to try again.  Messages that are sent
 * before the process runs wait in its link. */
static void
start_or_wait(struct child *c)
{
    int rc;

    c->process = malloc(sizeof *c->process);
    if (!c->process)
        log_out_of_memory();
    rc = start(c);
    c->process->data = c;
    if (rc == 0) {
        c->state = CHILD_RUNS;
        log_debug("child started pid=%d", c->process->pid);
        drop_link(c);
        return;
    }
    uv_close((uv_handle_t *)c->process, free_handle);
    c->process = NULL;
    if (!may_pass(rc) || c->tries >= AGAIN_FOR) {
        give_up(c, rc);
        return;
    }
    if (c->tries++ == 0)
        log_warn("child waits for a process why=%s", uv_strerror(rc));
    uv_timer_start(&c->again, try_start, AGAIN_MS, 0);
}

static void
try_start(uv_timer_t *again)
{
    start_or_wait(again->data);
}

/* Make the child's link; returns our end of it, NULL on failure. */
static uv_stream_t *
open_link(struct child *c)
{
    uv_stream_t *stream = conn_stream_new(&c->all->shell->daemon->loop, true);
    uv_os_sock_t ends[2];
    int rc;

    if (!stream)
        log_out_of_memory(); /* else the machine would wait for ever */
    rc = uv_socketpair(SOCK_STREAM, 0, ends, UV_NONBLOCK_PIPE, 0);
    if (rc == 0) {
        c->link = ends[1];
        rc = uv_pipe_open((uv_pipe_t *)stream, ends[0]);
        if (rc < 0)
            close(ends[0]);
    }
    if (rc == 0)
        return stream;
    give_up(c, rc);
    conn_stream_close(stream);
    return NULL;
}

void
children_spawn(struct children *all, uint64_t id, uint32_t memory_mib)
{
    struct child *c = calloc(1, sizeof *c);
    uv_stream_t *stream;
    char name[32];

    if (!c)
        log_out_of_memory(); /* else the machine would wait for ever */
    c->all = all;
    c->id = id;
    c->link = -1;
    c->how = (struct child_end){ -1, -1 };
    c->own_mib = memory_mib;
    c->memory_mib = lower_limit(all->conf.memory_mib, memory_mib);
    uv_timer_init(&all->shell->daemon->loop, &c->again);
    c->again.data = c;
    c->next = all->list;
    all->list = c;
    stream = open_link(c);
    if (!stream) {
        shell_gone(all->shell, id, c->text);
        return;
    }
    snprintf(name, sizeof name, "child:%llu",
             (unsigned long long)(id & ~ACT_OWN_CONN));
    if (!shell_add(all->shell, id, stream, NULL, MSG_AT_PARENT_NEW, name))
        shell_gone(all->shell, id, "out of memory");
    else /* no silence is too long: threads may keep the child busy */
        conn_live(shell_conn(all->shell, id), false);
    if (c->state == CHILD_WAITS)
        start_or_wait(c);
}

/* The link has ended: kill the process, for it is useless without the link. */
static void
link_ended(struct child *c)
{
    if (c->state == CHILD_RUNS) {
        uv_process_kill(c->process, SIGKILL);
        c->state = CHILD_DIES;
        return;
    }
    if (c->state == CHILD_DIES)
        return;
    uv_timer_stop(&c->again);
    drop_link(c);
    c->state = CHILD_OVER;
}

void
children_kill(struct children *all, uint64_t id)
{
    struct child *c = find(all, id);

    if (!c)
        return;
    c->silent = true;
    shell_remove(all->shell, id);
    link_ended(c);
    settle(c);
}

bool
children_closed(struct children *all, uint64_t id, const char *why)
{
    struct child *c = find(all, id);

    if (!c)
        return false;
    /* a dying child closes its link first: its exit status will say more */
    if (c->state != CHILD_EXITED && strcmp(why, CONN_BROKE_PROTOCOL) == 0)
        snprintf(c->text, sizeof c->text, "it broke the protocol");
    link_ended(c);
    settle(c);
    return true;
}

void
children_hold(struct children *all, child_hold_fn *hold)
{
    for (struct child *c = all->list; c; c = c->next) {
        struct conn *link = shell_conn(all->shell, c->id);
        bool held = link && hold(all->arg, c->id, c->held);

        if (link && held != c->held)
            conn_pause(link, held);
        c->held = held;
    }
}

void
children_kill_all(struct children *all)
{
    for (struct child *c = all->list; c; c = c->next) {
        c->silent = true;
        link_ended(c);
        settle(c);
    }
}
