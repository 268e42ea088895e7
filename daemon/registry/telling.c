/* telling.c - see telling.h */
#include "config.h"

#include "registry/telling.h"

#include "registry/stats.h"

#include <stdlib.h>
#include <string.h>

void
telling_drop_settling(struct coord_conn *conn, struct coord_settling **at)
{
    struct coord_settling *s = *at;

    *at = s->next;
    free(s);
    conn->answers--;
}

bool
telling_begin(struct coord_conn *conn, struct coord_telling *t,
              const struct job *job, uint64_t now_ms)
{
    t->text = stats_begin(job, now_ms);
    conn->payer->told.making = t->text;
    return t->text;
}

void
telling_whole(struct coord_conn *conn, struct coord_telling *t)
{
    struct coord_told *told = &conn->payer->told;

    t->whole = stats_take(t->text);
    t->text = NULL;
    t->len = strlen(t->whole);
    told->making = NULL;
    told->bytes += t->len;
}

void
telling_drop(struct coord_conn *conn, struct coord_telling **at)
{
    struct coord_telling *t = *at;
    struct coord_told *told = &conn->payer->told;

    if (t->text)
        told->making = NULL;
    told->bytes -= t->len;
    *at = t->next;
    stats_free(t->text);
    free(t->whole);
    free(t);
    conn->answers--;
}

bool
telling_of(const struct coord *c, const struct job *job)
{
    for (const struct coord_conn *i = c->conns; i; i = i->next)
        for (const struct coord_telling *t = i->telling; t; t = t->next)
            if (t->text && t->sequence == job->sequence)
                return true;
    return false;
}

void
telling_release(struct coord_conn *conn)
{
    while (conn->settling)
        telling_drop_settling(conn, &conn->settling);
    while (conn->telling)
        telling_drop(conn, &conn->telling);
}
