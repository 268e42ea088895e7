/* check_known.c - which files of the store a user may know of */
#include "config.h"

#include "users/known.h"
#include "tests/unit.h"

#include <string.h>

static struct known k;

static void
release(void)
{
    known_release(&k);
}

FIXTURE(NULL, release)

/* As hashes are: different from the first byte on. */
static const uint8_t *
nth(uint32_t i)
{
    static uint8_t hash[MSG_HASH];
    uint32_t mixed = i * 2654435761u;

    memcpy(hash, &mixed, sizeof mixed);
    memcpy(hash + 4, &i, sizeof i);
    return hash;
}

TEST(all_that_were_sent_are_known_and_no_others)
{
    for (uint32_t i = 0; i < 5000; i++)
        ck_assert(known_sent(&k, 1, nth(i)));
    ck_assert(known_sent(&k, 2, nth(7)));
    ck_assert_uint_eq(k.n, 5000);
    for (uint32_t i = 0; i < 10000; i++)
        ck_assert_int_eq(known_has(&k, nth(i)), i < 5000);
}

TEST(they_expire_by_themselves_and_not_while_jobs_name_them)
{
    uint8_t named[2 * MSG_HASH];
    const struct msg_hashes files = { 2, named };

    memcpy(named, nth(1), MSG_HASH);
    memcpy(named + MSG_HASH, nth(2), MSG_HASH);
    for (uint32_t i = 0; i < 4; i++)
        known_sent(&k, 100 * i, nth(i));
    ck_assert(known_name(&k, &files));
    ck_assert(known_name(&k, &files));
    known_expire(&k, 200);
    ck_assert(!known_has(&k, nth(0)));
    ck_assert(known_has(&k, nth(1)) && known_has(&k, nth(2)));
    ck_assert(known_has(&k, nth(3)));
    known_unname(&k, 400, &files);
    known_expire(&k, 1000);
    ck_assert_uint_eq(k.n, 2);
    known_unname(&k, 1000, &files);
    known_expire(&k, 1000);
    ck_assert_uint_eq(k.n, 2);
    known_expire(&k, 1001);
    ck_assert_uint_eq(k.n, 0);
}

TEST(whoever_sends_without_end_has_a_bound)
{
    uint32_t last = 3 * KNOWN_MOST;

    for (uint32_t i = 0; i < last; i++) {
        ck_assert(known_sent(&k, i, nth(i)));
        ck_assert_uint_le(k.nfree, KNOWN_MOST);
    }
    ck_assert(known_has(&k, nth(last - 1)));
    ck_assert(!known_has(&k, nth(0)));
}

/* All in a moment: no age tells them apart. */
TEST(whoever_sends_all_at_once_has_a_bound_too)
{
    for (uint32_t i = 0; i < 2 * KNOWN_MOST; i++) {
        ck_assert(known_sent(&k, 5, nth(i)));
        ck_assert_uint_le(k.nfree, KNOWN_MOST);
    }
}
