/* units.c - see units.h */
#include "config.h"

#include "observer/units.h"

#include "observer/markup.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

static const char marker[] = ",\n \"units\": [";

/* --- reading --- */

/* The object that the text begins, closed where its units begin. */
static json_t *
read_head(const char *text, size_t len)
{
    char *copy = malloc(len + 2);
    json_t *head = NULL;

    if (!copy)
        return NULL;
    memcpy(copy, text, len);
    copy[len] = '}';
    head = json_loadb(copy, len + 1, JSON_REJECT_DUPLICATES, NULL);
    free(copy);
    if (json_is_object(head))
        return head;
    json_decref(head);
    return NULL;
}

/* The number of that worker, UNITS_WORKERS when there are too many. */
static size_t
worker_of(struct units *u, const char *name)
{
    size_t i = 0;

    while (i < u->nworkers && strcmp(u->workers[i], name) != 0)
        i++;
    if (i < u->nworkers || i == UNITS_WORKERS)
        return i;
    u->workers[i] = strdup(name);
    if (!u->workers[i])
        return UNITS_WORKERS;
    u->nworkers++;
    return i;
}

static bool
add_span(struct units *u, const struct units_span *span)
{
    if (!rad_list_grow(&u->spans, u->nspans, sizeof *u->spans))
        return false;
    u->spans[u->nspans++] = *span;
    if (u->nspans == 1 || span->start < u->start_s)
        u->start_s = span->start;
    if (span->end > u->end_s)
        u->end_s = span->end;
    return true;
}

/* False: memory is out. */
static bool
add_unit(struct units *u, const json_t *unit, enum units_kind kind)
{
    double start = markup_number(unit, "start_s");
    double end = markup_number(unit, "end_s");
    size_t worker = worker_of(u, markup_member(unit, "worker"));

    if (worker == UNITS_WORKERS || !(start >= 0) || !(end >= start) ||
        end > 1e9)
        return true;
    return add_span(u, &(struct units_span){ .start = (float)start,
                                             .end = (float)end,
                                             .worker = (uint16_t)worker,
                                             .units = 1,
                                             .kind = kind });
}

/* One value after the other, up to the list's end. */
static int
read_list(struct units *u, const char *p, size_t n, struct rad_error *err)
{
    json_error_t at;

    for (;;) {
        json_t *unit;
        bool ok;

        while (n > 0 && strchr(" \n\t\r,", *p) && *p) {
            p++;
            n--;
        }
        if (n > 0 && *p == ']')
            return 0;
        unit = json_loadb(p, n, JSON_DISABLE_EOF_CHECK, &at);
        if (!json_is_object(unit) || at.position <= 0 ||
            (size_t)at.position > n) {
            json_decref(unit);
            return rad_fail(err, RAD_EDATA, "the list of units is damaged");
        }
        ok = add_unit(u, unit, UNITS_DONE);
        json_decref(unit);
        if (!ok)
            return rad_fail_memory(err);
        p += at.position;
        n -= (size_t)at.position;
    }
}

/* Add the units of a list of the head. */
static int
add_list(struct units *u, const char *list, enum units_kind kind,
         struct rad_error *err)
{
    const json_t *unit;
    size_t i;

    json_array_foreach(json_object_get(u->head, list), i, unit)
    {
        if (!add_unit(u, unit, kind))
            return rad_fail_memory(err);
    }
    return 0;
}

/* --- lanes --- */

static int
by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Workers in the order of their names. */
static bool
sort_workers(struct units *u)
{
    char **had = malloc((u->nworkers + 1) * sizeof *had);

    if (!had)
        return false;
    memcpy(had, u->workers, u->nworkers * sizeof *had);
    qsort(u->workers, u->nworkers, sizeof *u->workers, by_name);
    for (size_t i = 0; i < u->nspans; i++) {
        uint16_t to = 0;

        while (u->workers[to] != had[u->spans[i].worker])
            to++;
        u->spans[i].worker = to;
    }
    free(had);
    return true;
}

static int
by_start(const void *a, const void *b)
{
    const struct units_span *p = a, *q = b;

    if (p->worker != q->worker)
        return p->worker < q->worker ? -1 : 1;
    if (p->start != q->start)
        return p->start < q->start ? -1 : 1;
    return p->end < q->end ? -1 : p->end > q->end;
}

static int
by_lane(const void *a, const void *b)
{
    const struct units_span *p = a, *q = b;

    if (p->worker == q->worker && p->lane != q->lane)
        return p->lane < q->lane ? -1 : 1;
    return by_start(a, b);
}

/* Units of one worker that overlap lie side by side, as its threads do. */
static void
lay_out(struct units *u)
{
    float until[UNITS_LANES] = { 0 };

    for (size_t i = 0; i < u->nspans; i++) {
        struct units_span *s = &u->spans[i];
        uint16_t lane = 0;

        if (i > 0 && s->worker != s[-1].worker)
            memset(until, 0, sizeof until);
        while (lane < UNITS_LANES - 1 && until[lane] > s->start + 1e-6f)
            lane++;
        s->lane = lane;
        until[lane] = s->end > until[lane] ? s->end : until[lane];
        if (u->lanes[s->worker] <= lane)
            u->lanes[s->worker] = (uint16_t)(lane + 1);
    }
}

/* Join spans of a lane with gaps of at most `gap` between them. */
static void
join(struct units *u, float gap)
{
    size_t n = 0;

    for (size_t i = 0; i < u->nspans; i++) {
        const struct units_span *s = &u->spans[i];
        struct units_span *last = n > 0 ? &u->spans[n - 1] : NULL;

        if (!last || last->worker != s->worker || last->lane != s->lane ||
            last->kind != s->kind || s->start - last->end > gap) {
            u->spans[n++] = *s;
            continue;
        }
        last->end = s->end > last->end ? s->end : last->end;
        last->units += s->units;
    }
    u->nspans = n;
}

static void
thin_out(struct units *u)
{
    double all = u->end_s - u->start_s, gap = all / 4000;

    for (; u->nspans > UNITS_SPANS && gap > 0 && gap <= all; gap *= 2)
        join(u, (float)gap);
    if (u->nspans > UNITS_SPANS)
        u->nspans = UNITS_SPANS;
}

/* --- public --- */

int
units_read(struct units *u, const char *text, size_t len, struct rad_error *err)
{
    const char *list = memmem(text, len, marker, strlen(marker));
    int rc;

    *u = (struct units){ 0 };
    if (!list)
        return rad_fail(err, RAD_EDATA, "there is no list of units");
    if (list - text > UNITS_HEAD)
        return rad_fail(err, RAD_EDATA, "the statistics are too long");
    u->head = read_head(text, (size_t)(list - text));
    if (!u->head)
        return rad_fail(err, RAD_EDATA, "the statistics are damaged");
    u->workers = calloc(UNITS_WORKERS, sizeof *u->workers);
    u->lanes = calloc(UNITS_WORKERS, sizeof *u->lanes);
    list += strlen(marker);
    rc = u->workers && u->lanes
             ? read_list(u, list, len - (size_t)(list - text), err)
             : rad_fail_memory(err);
    if (rc == 0)
        rc = add_list(u, "running", UNITS_RUN, err);
    if (rc == 0)
        rc = add_list(u, "passes", UNITS_PASS, err);
    if (rc == 0 && !sort_workers(u))
        rc = rad_fail_memory(err);
    if (rc < 0) {
        units_release(u);
        return rc;
    }
    for (size_t i = 0; i < u->nworkers; i++)
        u->lanes[i] = 1;
    if (u->nspans > 0) {
        qsort(u->spans, u->nspans, sizeof *u->spans, by_start);
        lay_out(u);
        qsort(u->spans, u->nspans, sizeof *u->spans, by_lane);
        thin_out(u);
    }
    return 0;
}

void
units_release(struct units *u)
{
    for (size_t i = 0; i < u->nworkers; i++)
        free(u->workers[i]);
    free(u->workers);
    free(u->lanes);
    free(u->spans);
    json_decref(u->head);
    *u = (struct units){ 0 };
}
