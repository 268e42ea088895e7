/* fair.c - see fair.h */
#include "config.h"

#include "net/fair.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_BYTES 80 /* of a user's name, with its NUL */

/* How much a user may leave unread before fair_set_unread() is called. */
#define UNREAD_HIGH ((size_t)32 << 20)

struct fair_user {
    struct fair *fair;
    struct fair_user *next_known; /* in the list of all users */
    struct fair_user *next;       /* in line */
    bool waits;
    struct fair_place *first, **last; /* its connections in line */
    size_t unread;
    unsigned conns;
    char name[NAME_BYTES];
};

static void
stand(struct fair_user *u)
{
    struct fair *f = u->fair;

    u->waits = true;
    u->next = NULL;
    *f->last = u;
    f->last = &u->next;
}

static struct fair_user *
call_user(struct fair *f)
{
    struct fair_user *u = f->first;

    f->first = u->next;
    if (!f->first)
        f->last = &f->first;
    u->waits = false;
    return u;
}

static bool
is_full(const struct fair_user *u)
{
    return u->unread >= u->fair->unread_high;
}

/* Has a user who left too much unread read enough to be served again? */
static bool
has_room(const struct fair_user *u)
{
    return u->unread <= u->fair->unread_high / 4 * 3;
}

static void
on_awake(uv_idle_t *h)
{
    (void)h; /* an idle handle keeps the loop from waiting */
}

/* A connection stands in line: do not let the loop wait. */
static void
wake(struct fair *f)
{
    if (f->open)
        uv_idle_start(&f->awake, on_awake);
}

/* --- standing in line --- */

static void
line_up(struct fair_place *p)
{
    struct fair_user *u = p->user;

    if (p->waits)
        return;
    p->waits = true;
    p->next = NULL;
    *u->last = p;
    u->last = &p->next;
    if (!u->waits && !is_full(u)) {
        stand(u);
        wake(u->fair);
    }
}

static void
step_out(struct fair_place *p)
{
    struct fair_user *u = p->user;
    struct fair_place **at = &u->first;

    if (!p->waits)
        return;
    while (*at != p)
        at = &(*at)->next;
    *at = p->next;
    if (!*at)
        u->last = at;
    p->waits = false;
}

static bool
has_time(const struct fair *f)
{
    return f->spent_ns < FAIR_MS * UINT64_C(1000000);
}

bool
fair_begin(struct fair_place *p)
{
    struct fair_user *u = p->user;
    struct fair *f;
    bool may;

    if (!u)
        return true;
    f = u->fair;
    if (f->serving == p) {
        may = f->granted;
        f->granted = false;
    } else {
        may =
            !f->serving && !f->first && !u->first && !is_full(u) && has_time(f);
    }
    if (may)
        f->since_ns = f->clock();
    else
        line_up(p);
    return may;
}

void
fair_done(struct fair_place *p)
{
    struct fair *f;

    if (!p->user)
        return;
    f = p->user->fair;
    f->spent_ns += f->clock() - f->since_ns;
}

/* Let the next connection of the next user have one request looked at. */
static void
serve_one(struct fair *f)
{
    struct fair_user *u = call_user(f);
    struct fair_place *p = u->first;

    if (!p || is_full(u))
        return;
    step_out(p);
    f->serving = p;
    f->granted = true;
    u->conns++; /* go() may end the connection, but must not free the user */
    p->go(p);
    u->conns--;
    f->serving = NULL;
    if (u->first && !u->waits && !is_full(u))
        stand(u);
}

static void drop_unused(struct fair *f);

static void
on_after(uv_check_t *h)
{
    struct fair *f = h->data;

    while (f->first && has_time(f))
        serve_one(f);
    f->spent_ns = 0;
    if (!f->first)
        uv_idle_stop(&f->awake);
    drop_unused(f);
}

/* --- unread answers --- */

void
fair_owe(struct fair_place *p, size_t n)
{
    if (p->user)
        p->user->unread += n;
}

void
fair_paid(struct fair_place *p, size_t n)
{
    struct fair_user *u = p->user;

    if (!u)
        return;
    u->unread -= n;
    if (u->first && !u->waits && has_room(u)) {
        stand(u);
        wake(u->fair);
    }
}

bool
fair_full(const struct fair_place *p)
{
    return p->user && is_full(p->user);
}

void
fair_set_unread(struct fair *f, size_t bytes)
{
    f->unread_high = bytes;
}

/* --- users --- */

static struct fair_user *
find(const struct fair *f, const char *name)
{
    struct fair_user *u = f->users;

    while (u && strncmp(u->name, name, NAME_BYTES - 1) != 0)
        u = u->next_known;
    return u;
}

size_t
fair_unread(const struct fair *f, const char *name)
{
    const struct fair_user *u = find(f, name);

    return u ? u->unread : 0;
}

struct fair_user *
fair_join(struct fair *f, const char *name)
{
    struct fair_user *u = find(f, name);

    if (!u) {
        u = calloc(1, sizeof *u);
        if (!u)
            return NULL;
        snprintf(u->name, sizeof u->name, "%s", name);
        u->fair = f;
        u->last = &u->first;
        u->next_known = f->users;
        f->users = u;
    }
    u->conns++;
    return u;
}

/* Free users without connections.  One that still stands in line, because its
 * connection left in this turn, is freed later. */
static void
drop_unused(struct fair *f)
{
    struct fair_user **at = &f->users;

    while (*at) {
        struct fair_user *u = *at;

        if (u->conns > 0 || u->waits) {
            at = &u->next_known;
        } else {
            *at = u->next_known;
            free(u);
        }
    }
}

void
fair_leave(struct fair_place *p)
{
    struct fair_user *u = p->user;

    if (!u)
        return;
    step_out(p);
    u->conns--;
    p->user = NULL;
    if (!u->fair->open) /* no turn of the loop will free it */
        drop_unused(u->fair);
}

/* --- the loop --- */

void
fair_init(struct fair *f, uv_loop_t *loop)
{
    memset(f, 0, sizeof *f);
    f->clock = uv_hrtime;
    f->last = &f->first;
    f->unread_high = UNREAD_HIGH;
    f->open = true;
    uv_check_init(loop, &f->after);
    uv_idle_init(loop, &f->awake);
    f->after.data = f;
    uv_check_start(&f->after, on_after);
}

void
fair_close(struct fair *f)
{
    if (!f->open)
        return;
    f->open = false;
    while (f->first)
        call_user(f);
    uv_close((uv_handle_t *)&f->after, NULL);
    uv_close((uv_handle_t *)&f->awake, NULL);
    drop_unused(f);
}
