/* children.c - see children.h */
#include "config.h"

#include "children.h"

#include "log.h"
#include "render.h"
#include "service.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

struct child {
    uv_process_t process;
    struct child *next;
    struct children *all;
    uint64_t id;
    bool exited;    /* the process has */
    bool link_gone; /* nothing more will come from it */
    bool silent;    /* nobody wants to know */
    struct child_end how;
    char text[160];
};

void
children_init(struct children *all, struct shell *shell,
              const struct children_conf *conf, child_ended_fn *ended,
              void *arg)
{
    all->shell = shell;
    all->conf = *conf;
    all->ended = ended;
    all->arg = arg;
    all->list = NULL;
    all->held = false;
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

/* Both ends have been seen: tell of it and forget it. */
static void
settle(struct child *c)
{
    struct children *all = c->all;
    struct child **at = &all->list;

    if (!c->exited || !c->link_gone)
        return;
    while (*at != c)
        at = &(*at)->next;
    *at = c->next;
    if (!c->silent)
        all->ended(all->arg, c->id, c->how, c->text);
    uv_close((uv_handle_t *)&c->process, free_child);
}

static void
on_exit_cb(uv_process_t *process, int64_t status, int signum)
{
    struct child *c = process->data;

    c->exited = true;
    if (!c->text[0])
        c->how = (struct child_end){ (int)status, signum };
    if (!c->text[0] && signum)
        snprintf(c->text, sizeof c->text, "killed by signal %d", signum);
    else if (!c->text[0])
        snprintf(c->text, sizeof c->text, "exit status %d", (int)status);
    settle(c);
}

/* Of two where 0 is none. */
static unsigned
lower_limit(int radds, uint32_t jobs)
{
    if (radds <= 0 || jobs == 0)
        return radds > 0 ? (unsigned)radds : jobs;
    return (unsigned)radds < jobs ? (unsigned)radds : jobs;
}

static int
start(struct child *c, uv_stream_t *stream, unsigned memory_mib)
{
    struct children *all = c->all;
    char threads[16], memory[16], nice[16], pixel[16];
    char *args[] = { (char *)"radd",
                     (char *)RENDER_CHILD_OPTION,
                     (char *)all->conf.files_dir,
                     threads,
                     memory,
                     nice,
                     pixel,
                     (char *)(all->conf.sandboxed ? RENDER_SANDBOXED : ""),
                     NULL };
    uv_stdio_container_t fds[] = {
        { .flags = UV_IGNORE },
        { .flags = UV_INHERIT_FD, .data.fd = 2 },
        { .flags = UV_INHERIT_FD, .data.fd = 2 },
        { .flags = (uv_stdio_flags)(UV_CREATE_PIPE | UV_READABLE_PIPE |
                                    UV_WRITABLE_PIPE),
          .data.stream = stream },
    };
    uv_process_options_t o = { .exit_cb = on_exit_cb,
                               .file = "/proc/self/exe",
                               .args = args,
                               .stdio = fds,
                               .stdio_count = RENDER_LINK_FD + 1 };

    snprintf(threads, sizeof threads, "%d", all->conf.threads);
    snprintf(memory, sizeof memory, "%u", memory_mib);
    snprintf(pixel, sizeof pixel, "%d", all->conf.pixel_s);
    snprintf(nice, sizeof nice, "%d", all->conf.nice);
    return uv_spawn(all->shell->loop, &c->process, &o);
}

void
children_spawn(struct children *all, uint64_t id, uint32_t memory_mib)
{
    struct child *c = calloc(1, sizeof *c);
    uv_stream_t *stream = conn_stream_new(all->shell->loop, true);
    char name[32];
    int rc;

    if (!c || !stream)
        service_out_of_memory(); /* the machine would wait for ever */
    c->all = all;
    c->id = id;
    c->how = (struct child_end){ -1, -1 };
    c->process.data = c;
    c->next = all->list;
    all->list = c;
    rc = start(c, stream, lower_limit(all->conf.memory_mib, memory_mib));
    if (rc < 0) {
        c->exited = true;
        c->how = (struct child_end){ EX_OSERR, 0 };
        snprintf(c->text, sizeof c->text, "cannot start: %s", uv_strerror(rc));
        conn_stream_close(stream);
        shell_gone(all->shell, id, c->text);
        return;
    }
    snprintf(name, sizeof name, "child:%d", c->process.pid);
    log_debug("child started pid=%d", c->process.pid);
    if (!shell_add(all->shell, id, stream, NULL, MSG_AT_PARENT_NEW, name))
        shell_gone(all->shell, id, "out of memory");
    else /* it may take its time */
        conn_live(shell_conn(all->shell, id), false);
    if (all->held)
        children_hold(all, true);
}

static void
kill_child(struct child *c)
{
    if (!c->exited)
        uv_process_kill(&c->process, SIGKILL);
}

void
children_kill(struct children *all, uint64_t id)
{
    struct child *c = find(all, id);

    if (!c)
        return;
    c->silent = true;
    c->link_gone = true;
    shell_remove(all->shell, id);
    kill_child(c);
    settle(c);
}

bool
children_closed(struct children *all, uint64_t id, const char *why)
{
    struct child *c = find(all, id);

    if (!c)
        return false;
    c->link_gone = true;
    /* a child that dies closes its link first: how it died says more */
    if (!c->exited && strcmp(why, CONN_BROKE_PROTOCOL) == 0)
        snprintf(c->text, sizeof c->text, "it broke the protocol");
    kill_child(c); /* without a link it is of no use */
    settle(c);
    return true;
}

void
children_hold(struct children *all, bool held)
{
    all->held = held;
    for (struct child *c = all->list; c; c = c->next)
        if (shell_conn(all->shell, c->id))
            conn_pause(shell_conn(all->shell, c->id), held);
}

void
children_kill_all(struct children *all)
{
    for (struct child *c = all->list; c; c = c->next) {
        c->silent = true;
        c->link_gone = true;
        kill_child(c);
    }
}
