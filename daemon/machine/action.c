/* action.c - see action.h */
#include "config.h"

#include "machine/action.h"

#include "proto/frame.h"

#include "base/list.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void
actions_init(struct action_list *l)
{
    memset(l, 0, sizeof *l);
    rad_arena_init(&l->mem);
    wire_out_init(&l->scratch, MSG_FRAME_MAX);
}

static void
free_texts(struct action_list *l)
{
    while (l->ntexts > 0)
        free(l->texts[--l->ntexts]);
}

void
actions_release(struct action_list *l)
{
    free_texts(l);
    free(l->texts);
    free(l->v);
    rad_arena_release(&l->mem);
    wire_out_release(&l->scratch);
}

void
actions_clear(struct action_list *l)
{
    l->n = 0;
    free_texts(l);
    rad_arena_rewind(&l->mem, (struct rad_arena_mark){ 0 });
}

struct action *
actions_add(struct action_list *l, enum action_type type, uint64_t conn)
{
    if (l->n == l->cap) {
        size_t cap = l->cap ? 2 * l->cap : 64;
        struct action *v = realloc(l->v, cap * sizeof *v);

        if (!v) {
            l->failed = true;
            return NULL;
        }
        l->v = v;
        l->cap = cap;
    }
    l->v[l->n] = (struct action){ .type = type, .conn = conn };
    return &l->v[l->n++];
}

void *
actions_keep(struct action_list *l, const void *bytes, size_t len)
{
    void *copy = rad_arena_dup(&l->mem, bytes, len);

    if (!copy)
        l->failed = true;
    return copy;
}

char *
actions_keep_text(struct action_list *l, const char *text)
{
    return actions_keep(l, text, strlen(text) + 1);
}

struct action *
actions_add_job(struct action_list *l, enum action_type type, uint64_t conn,
                const uint8_t job[MSG_JOB])
{
    const uint8_t *copy = actions_keep(l, job, MSG_JOB);
    struct action *a = copy ? actions_add(l, type, conn) : NULL;

    if (a)
        a->job = copy;
    return a;
}

void
actions_send(struct action_list *l, uint64_t conn, const struct msg *m)
{
    l->scratch.len = 0;
    if (msg_pack(&l->scratch, m) != 0) {
        l->failed = true;
        return;
    }
    actions_send_bytes(l, conn, l->scratch.buf, l->scratch.len);
}

void
actions_send_bytes(struct action_list *l, uint64_t conn, const uint8_t *bytes,
                   size_t len)
{
    uint8_t *copy = actions_keep(l, bytes, len);

    if (copy)
        actions_send_kept(l, conn, copy, len);
}

void
actions_send_kept(struct action_list *l, uint64_t conn, const uint8_t *kept,
                  size_t len)
{
    struct action *a = actions_add(l, ACT_SEND, conn);

    if (!a)
        return;
    a->bytes = kept;
    a->len = len;
}

bool
actions_own(struct action_list *l, char *text)
{
    if (!rad_list_grow(&l->texts, l->ntexts, sizeof *l->texts)) {
        free(text);
        l->failed = true;
        return false;
    }
    l->texts[l->ntexts++] = text;
    return true;
}

char *
actions_take(struct action_list *l, const uint8_t *text)
{
    for (size_t i = 0; i < l->ntexts; i++)
        if ((const uint8_t *)l->texts[i] == text) {
            char *taken = l->texts[i];

            l->texts[i] = l->texts[--l->ntexts];
            return taken;
        }
    return NULL;
}

void
actions_session(struct action_list *l, uint64_t conn, enum msg_session session,
                unsigned version)
{
    struct action *a = actions_add(l, ACT_SESSION, conn);

    if (!a)
        return;
    a->session = session;
    a->version = version;
}

void
actions_close(struct action_list *l, uint64_t conn)
{
    actions_add(l, ACT_CLOSE, conn);
}

void
actions_log(struct action_list *l, enum action_level level, const char *fmt,
            ...)
{
    char buf[512];
    struct action *a;
    va_list ap;

    va_start(ap, fmt);
    vsnprintf(buf, sizeof buf, fmt, ap);
    va_end(ap);
    a = actions_add(l, ACT_LOG, 0);
    if (!a)
        return;
    a->level = level;
    a->text = actions_keep_text(l, buf);
}
