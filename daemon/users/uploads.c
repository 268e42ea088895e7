/* uploads.c - see uploads.h */
#include "config.h"

#include "users/uploads.h"

#include <stdlib.h>
#include <string.h>

struct upload {
    struct upload *next; /* in its bucket */
    uint8_t hash[MSG_HASH];
    uint64_t conn;             /* 0: the file is whole, and waits */
    uint64_t since_ms;         /* when it began to wait, or last came again */
    uint64_t bytes;            /* as the file counts in *payer */
    struct uploads_sum *payer; /* of the user who sends the file */
};

/* Hashes are as good as random. */
static struct upload **
bucket_of(const struct uploads *u, const uint8_t *hash)
{
    unsigned i = (unsigned)(hash[0] << 8 | hash[1]) % UPLOADS_BUCKETS;

    return (struct upload **)&u->bucket[i];
}

/* The pointer to a file's upload: on its way over conn, or waiting (conn 0), of
 * *payer or of any user (NULL).  If there is none, the pointer to NULL at the
 * bucket's end. */
static struct upload **
find(const struct uploads *u, uint64_t conn, const struct uploads_sum *payer,
     const uint8_t *hash)
{
    struct upload **at = bucket_of(u, hash);

    while (*at && ((*at)->conn != conn || (payer && (*at)->payer != payer) ||
                   memcmp((*at)->hash, hash, MSG_HASH) != 0))
        at = &(*at)->next;
    return at;
}

static void
drop(struct uploads *u, struct upload **at)
{
    struct upload *f = *at;

    *at = f->next;
    f->payer->under_way -= f->conn != 0;
    f->payer->bytes -= f->bytes;
    u->n--;
    free(f);
}

void
uploads_release(struct uploads *u)
{
    for (int i = 0; i < UPLOADS_BUCKETS; i++)
        while (u->bucket[i])
            drop(u, &u->bucket[i]);
}

bool
uploads_knows(const struct uploads *u, uint64_t conn,
              const uint8_t hash[MSG_HASH])
{
    return *find(u, conn, NULL, hash) != NULL;
}

bool
uploads_begin(struct uploads *u, uint64_t conn, const uint8_t hash[MSG_HASH],
              uint64_t total, struct uploads_sum *payer)
{
    struct upload *f = calloc(1, sizeof *f), **at = bucket_of(u, hash);

    if (!f)
        return false;
    memcpy(f->hash, hash, MSG_HASH);
    f->conn = conn;
    f->bytes = total > UPLOADS_LEAST ? total : UPLOADS_LEAST;
    f->payer = payer;
    payer->under_way++;
    payer->bytes += f->bytes;
    f->next = *at;
    *at = f;
    u->n++;
    return true;
}

void
uploads_whole(struct uploads *u, uint64_t conn, const uint8_t hash[MSG_HASH],
              uint64_t now_ms)
{
    struct upload **at = find(u, conn, NULL, hash), *f = *at;
    struct upload **other;

    if (!f)
        return;
    other = find(u, 0, f->payer, hash);
    if (*other) { /* the user sent the file twice; the store has it once */
        (*other)->since_ms = now_ms;
        drop(u, at);
        return;
    }
    f->payer->under_way--;
    f->conn = 0;
    f->since_ms = now_ms;
}

void
uploads_failed(struct uploads *u, uint64_t conn, const uint8_t hash[MSG_HASH])
{
    struct upload **at = find(u, conn, NULL, hash);

    if (*at)
        drop(u, at);
}

uint64_t
uploads_kept_from(const struct uploads_sum *payer, uint64_t since_ms)
{
    if (payer->moved_ms <= since_ms || payer->offer_ms > since_ms)
        return since_ms;
    return payer->offer_ms - 1; /* a file may come within the same ms */
}

/* Drop the uploads of a connection; with conn 0, the uploads that have waited
 * for a job since since_ms or longer. */
static void
drop_all(struct uploads *u, uint64_t conn, uint64_t since_ms)
{
    for (int i = 0; i < UPLOADS_BUCKETS && u->n > 0; i++)
        for (struct upload **at = &u->bucket[i]; *at;)
            if ((*at)->conn == conn &&
                (conn != 0 ||
                 (*at)->since_ms <= uploads_kept_from((*at)->payer, since_ms)))
                drop(u, at);
            else
                at = &(*at)->next;
}

void
uploads_closed(struct uploads *u, uint64_t conn)
{
    drop_all(u, conn, 0);
}

void
uploads_named(struct uploads *u, const struct uploads_sum *payer,
              const struct msg_hashes *files)
{
    for (uint32_t i = 0; i < files->n && u->n > 0; i++) {
        struct upload **at =
            find(u, 0, payer, files->hash + (size_t)i * MSG_HASH);

        if (*at)
            drop(u, at);
    }
}

void
uploads_offered(struct uploads *u, const struct uploads_sum *payer,
                const uint8_t hash[MSG_HASH], uint64_t now_ms)
{
    struct upload *f = *find(u, 0, payer, hash);

    if (f)
        f->since_ms = now_ms;
}

void
uploads_forget(struct uploads *u, uint64_t since_ms)
{
    drop_all(u, 0, since_ms);
}

size_t
uploads_waiting(const struct uploads *u, uint8_t *hashes)
{
    size_t n = 0;

    for (int i = 0; i < UPLOADS_BUCKETS; i++)
        for (const struct upload *f = u->bucket[i]; f; f = f->next)
            if (f->conn == 0)
                memcpy(hashes + n++ * MSG_HASH, f->hash, MSG_HASH);
    return n;
}
