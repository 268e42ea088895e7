/* check_uploads.c - files that users send, and what they count */
#include "config.h"

#include "users/uploads.h"

#include "tests/unit.h"

#include <string.h>

#define BYTES UINT64_C(100000)

static struct uploads u;
static struct uploads_sum ana, ben;
static const uint8_t scene[MSG_HASH] = "scene", data[MSG_HASH] = "data";

/* The file comes whole by that connection. */
static void
comes(uint64_t conn, struct uploads_sum *payer, const uint8_t *hash,
      uint64_t now_ms)
{
    ck_assert(uploads_begin(&u, conn, hash, BYTES, payer));
    ck_assert_uint_eq(payer->under_way, 1);
    uploads_whole(&u, conn, hash, now_ms);
    ck_assert_uint_eq(payer->under_way, 0);
}

static void
job_names(struct uploads_sum *payer, const uint8_t *hash)
{
    uint8_t hashes[MSG_HASH];
    struct msg_hashes files = { .n = 1, .hash = hashes };

    memcpy(hashes, hash, MSG_HASH);
    uploads_named(&u, payer, &files);
}

static void
tear_down(void)
{
    uploads_release(&u);
    ck_assert_uint_eq(ana.bytes + ben.bytes, 0);
}

FIXTURE(NULL, tear_down)

TEST(a_file_counts_once_for_each_who_sent_it)
{
    comes(1, &ben, scene, 10);
    comes(2, &ana, scene, 20);
    comes(3, &ben, scene, 30);
    comes(4, &ana, data, 40);
    ck_assert_uint_eq(ana.bytes, 2 * BYTES);
    ck_assert_uint_eq(ben.bytes, BYTES);
}

TEST(what_is_sent_again_waits_from_then_on)
{
    comes(1, &ana, scene, 10);
    comes(2, &ben, scene, 20);
    comes(3, &ana, scene, 30);
    uploads_forget(&u, 20);
    ck_assert_uint_eq(ana.bytes, BYTES);
    ck_assert_uint_eq(ben.bytes, 0);
    uploads_forget(&u, 30);
    ck_assert_uint_eq(ana.bytes, 0);
}

TEST(a_job_takes_only_what_its_owner_sent)
{
    comes(1, &ana, scene, 10);
    job_names(&ben, scene);
    job_names(&ana, data);
    ck_assert_uint_eq(ana.bytes, BYTES);
    job_names(&ana, scene);
    ck_assert_uint_eq(ana.bytes, 0);
}

TEST(a_closed_connection_takes_its_unfinished_files)
{
    comes(1, &ana, scene, 10);
    ck_assert(uploads_begin(&u, 1, data, 1, &ana));
    ck_assert_uint_eq(ana.bytes, BYTES + UPLOADS_LEAST);
    ck_assert(uploads_knows(&u, 1, data));
    ck_assert(!uploads_knows(&u, 2, data));
    uploads_closed(&u, 1);
    ck_assert(!uploads_knows(&u, 1, data));
    ck_assert_uint_eq(ana.under_way, 0);
    ck_assert_uint_eq(ana.bytes, BYTES);
}
