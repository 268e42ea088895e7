/* check_passplan.c - which passes and tiles there are, by options and sizes */
#include "config.h"

#include "passes/passes.h"

#include "machine/jobtext.h"
#include "tests/unit.h"

#include <stdlib.h>
#include <string.h>

static const char *const none[] = { "-ab 0", "-ab 2 -aa 0", "-ab 2 -ad 0" };

LOOP_TEST(without_a_cache_there_are_no_passes, N_ELEM(none))
{
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_pass_size size = { 1920, 1080 };
    struct rad_params par;

    ck_assert_int_eq(jobtext_params(none[_i], &par, NULL), 0);
    ck_assert_uint_eq(rad_passes_plan(&par, &size, 1, pass), 0);
}

static const struct {
    struct rad_pass_size size;
    const char *options;
    int finest; /* step of the last lattice */
} plans[] = {
    { { 1, 1 }, "-ab 12 -ps 1", 2 },
    { { 1, 65535 }, "-ab 12 -ps 2", 2 },
    { { 100, 75 }, "-ab 12 -ps 3", 2 },
    { { 1920, 1280 }, "-ab 12 -ps 4", 4 },
    { { 7680, 4320 }, "-ab 12 -ps 5", 4 },
    { { 65535, 65535 }, "-ab 12 -ps 16", 4 },
};

/* A large picture's passes have tiles for many workers; a small one's have few,
 * for a tile costs a message, and makes some of its neighbours' records. */
TEST(large_pictures_have_many_tiles)
{
    static const struct rad_pass_size size[] = { { 3840, 2160 }, { 640, 640 } };
    struct rad_pass pass[2][RAD_MOST_PASSES];
    uint32_t n[2], rounds = 0;
    struct rad_params par;

    ck_assert_int_eq(jobtext_params("-ab 3 -ps 4", &par, NULL), 0);
    for (int k = 0; k < 2; k++)
        n[k] = rad_passes_plan(&par, &size[k], 1, pass[k]);
    for (uint32_t i = 0; i < n[0]; i++) {
        uint32_t paths = pass[0][i].end - pass[0][i].first;

        if (pass[0][i].level > 0 && paths >= 8 * 512)
            ck_assert_uint_eq(pass[0][i].tiles, 128);
        else if (pass[0][i].level > 0)
            ck_assert_uint_eq(pass[0][i].tiles, paths / 32);
        else
            ck_assert_uint_ge(pass[0][i].tiles, 50);
        rounds += pass[0][i].level > 0;
    }
    ck_assert_uint_gt(rounds, 0);
    for (uint32_t i = 0; i < n[1]; i++)
        ck_assert_uint_le(pass[1][i].tiles, 251);
}

/* Is that another part of the pass before? */
static bool
is_next_part(const struct rad_pass *k)
{
    return k->part > 0 && k[-1].part >= 0 && k[-1].part < k->part &&
           k[-1].level == k->level && k[-1].end == k->end &&
           k[-1].step == k->step && k[-1].field == k->field &&
           k[-1].scattered == k->scattered;
}

static void
check_reads(const struct rad_pass *k, uint32_t i)
{
    ck_assert_uint_le(k->reads, i);
    ck_assert_uint_lt(i - k->reads, RAD_PASS_PARTS);
    ck_assert(k->part >= 0 || k->reads == i);
    for (uint32_t j = 1; j <= i - k->reads; j++)
        ck_assert(k[-(int)j].part >= 0 && k[-(int)j].part != k->part);
    ck_assert(!is_next_part(k) || k->reads < i);
}

/* May tiles of pass i be made beside those of pass `beside`, before it? */
static bool
go_together(const struct rad_pass *pass, uint32_t n, uint32_t beside,
            uint32_t i)
{
    const struct rad_pass *a = &pass[beside], *b = &pass[i];

    if (b->level == 0) /* records are smoothed between them, or not yet */
        return !rad_pass_is_last(pass, n, beside);
    /* the ends of a round are dropped for those of the next but one */
    return a->level == 0 || a->round != b->round ||
           (a->level == b->level && a->first == b->first && a->end == b->end);
}

/* In a job of several batches. */
LOOP_TEST(a_pass_goes_without_nothing_that_threads_share, 4)
{
    enum { FRAMES = 80 };
    struct rad_pass_size size[FRAMES];
    struct rad_pass pass[RAD_MOST_PASSES];
    uint32_t n, without = 0;
    struct rad_params par;

    ck_assert_int_eq(
        jobtext_params(_i & 1 ? "-ab 4 -aa .2" : "-ab 1 -aa .2", &par, NULL),
        0);
    for (int i = 0; i < FRAMES; i++)
        size[i] = _i & 2 ? (struct rad_pass_size){ 3840, 2160 }
                         : (struct rad_pass_size){ 640, 480 };
    n = rad_passes_plan(&par, size, FRAMES, pass);
    for (uint32_t i = 0; i < n; i++) {
        ck_assert_uint_lt(i - pass[i].reads, RAD_PASS_PARTS);
        for (uint32_t k = pass[i].reads; k < i; k++, without++)
            ck_assert(go_together(pass, n, k, i));
    }
    ck_assert((without > 0) == (_i > 0));
}

/* Each path once, each pixel of the last lattice once, and every second one
 * along both axes once more for what tiles left out. */
LOOP_TEST(a_plan_asks_for_each_place_once, N_ELEM(plans))
{
    struct rad_pass pass[RAD_MOST_PASSES];
    uint32_t n, end = 0, parts = 0;
    int level = 12, done = 0;
    struct rad_params par;

    ck_assert_int_eq(jobtext_params(plans[_i].options, &par, NULL), 0);
    n = rad_passes_plan(&par, &plans[_i].size, 1, pass);
    ck_assert_uint_le(n, RAD_MOST_PASSES);
    ck_assert_int_eq(pass[0].walks, RAD_PASS_LEVELS);
    for (uint32_t i = 1; i < n; i++) {
        ck_assert_uint_gt(pass[i].tiles, 0);
        check_reads(&pass[i], i);
        ck_assert_int_eq(pass[i].walks, 0);
        ck_assert_int_le(pass[i].level, level);
        ck_assert(pass[i].scattered || !pass[i - 1].scattered);
        ck_assert(pass[i].scattered || pass[i].rays > 0);
        if (is_next_part(&pass[i])) {
            parts++;
            continue;
        }
        if (pass[i].level == 0) {
            if (pass[i].scattered) {
                ck_assert_int_eq(pass[i].step, 2 * done);
            } else if (pass[i].field == 1) {
                ck_assert_int_eq(pass[i - 1].step, pass[i].step);
            } else {
                ck_assert_int_eq(pass[i].done, done);
                ck_assert(done == 0 || pass[i].step == done / 2);
                done = pass[i].step;
            }
            if (pass[i].finest)
                ck_assert_int_le(pass[i].side * pass[i].step, RAD_PASS_PIXELS);
            ck_assert(pass[i].finest ==
                      (pass[i].scattered || pass[i].step == plans[_i].finest));
        } else {
            ck_assert_uint_eq(pass[i].first, pass[i].level < level ? 0 : end);
            ck_assert_uint_gt(pass[i].end, pass[i].first);
            ck_assert_uint_le(pass[i].end, pass[0].paths);
            end = pass[i].end;
        }
        level = pass[i].level;
    }
    ck_assert(pass[n - 1].scattered && pass[n - 1].rays == 0);
    ck_assert_uint_eq(end, pass[0].paths);
    ck_assert((parts > 0) == (plans[_i].size.height > 2048));
    ck_assert_int_eq(done, plans[_i].finest);
    ck_assert_int_eq(level, 0);
}

/* Plan the passes of so many frames of one size; returns their number. */
static uint32_t
plan_alike(const char *options, struct rad_pass_size each, uint32_t nframes,
           struct rad_pass pass[RAD_MOST_PASSES])
{
    struct rad_pass_size *size = calloc(nframes, sizeof *size);
    struct rad_params par;
    uint32_t n;

    ck_assert_ptr_nonnull(size);
    ck_assert_int_eq(jobtext_params(options, &par, NULL), 0);
    for (uint32_t i = 0; i < nframes; i++)
        size[i] = each;
    n = rad_passes_plan(&par, size, nframes, pass);
    free(size);
    return n;
}

static const struct rad_pass_size small = { 100, 75 };

/* Of any number of frames each has its last lattice once. */
LOOP_TEST(each_frame_is_planned_once, 41)
{
    enum { FRAMES = 1000 };
    static uint8_t times[FRAMES];
    struct rad_pass pass[RAD_MOST_PASSES];
    uint32_t nframes = (uint32_t)_i < 40 ? (uint32_t)_i + 1 : FRAMES;
    uint32_t n = plan_alike("-ab 12", small, nframes, pass);

    memset(times, 0, sizeof times);
    ck_assert_uint_le(n, RAD_MOST_PASSES);
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = pass[k].frame;
             pass[k].finest && pass[k].field < 1 && i < pass[k].beyond;
             i += pass[k].stride) {
            ck_assert_int_le(pass[k].side * pass[k].step, RAD_PASS_PIXELS);
            times[i] += !pass[k].scattered ? 1 : pass[k].first == 0 ? 16 : 0;
        }
    for (uint32_t i = 0; i < nframes; i++)
        ck_assert_uint_eq(times[i], 17);
}

static const uint32_t walks[] = { 32, 33, 40, 100, 1000, 3000 };

/* When the pictures of a batch are made, every fourth frame of the next batch
 * has been looked at, all frames before it, and none behind it. */
LOOP_TEST(a_batch_looks_at_frames_of_the_next, N_ELEM(walks))
{
    static bool seen[3000];
    struct rad_pass pass[RAD_MOST_PASSES];
    uint32_t nframes = walks[_i], ready = 0, next = 0;
    uint32_t n = plan_alike("-ab 2", small, nframes, pass);

    memset(seen, 0, sizeof seen);
    for (uint32_t k = 0; k < n; k++) {
        for (uint32_t i = pass[k].frame; pass[k].finest && i < pass[k].beyond;
             i += pass[k].stride)
            seen[i] = true;
        if (!rad_pass_is_last(pass, n, k))
            continue;
        ready = pass[k].ready;
        for (next = k + 1; next < n && pass[next].ready <= ready;)
            next++;
        next = next < n ? pass[next].ready : ready;
        for (uint32_t i = 0; i < nframes; i++)
            ck_assert(seen[i] ==
                      (i < ready || (i < next && (i + 1 - ready) % 4 == 0)));
    }
    ck_assert_uint_eq(ready, nframes);
}

/* What many frames' tiles left out is shared among as many more tiles. */
TEST(the_rest_of_many_frames_has_more_tiles)
{
    enum { FRAMES = 32 };
    const struct rad_pass_size large = { 1920, 1280 };
    struct rad_pass pass[RAD_MOST_PASSES];
    uint32_t n = plan_alike("-ab 1 -ps 4", large, FRAMES, pass);
    uint32_t single = 0, most = 0;

    for (uint32_t i = 0; i < n; i++) {
        if (!pass[i].scattered)
            continue;
        if (pass[i].beyond == 1)
            single = pass[i].tiles;
        if (pass[i].tiles > most)
            most = pass[i].tiles;
    }
    ck_assert_uint_gt(single, 100);
    ck_assert_uint_ge(most, FRAMES / 2 * single);
}

static const struct {
    struct rad_pass_size size;
    uint32_t rounds; /* 0: it is large */
} rests[] = {
    { { 1, 1 }, 1 },      { { 60, 60 }, 3 },     { { 200, 200 }, 6 },
    { { 948, 948 }, 11 }, { { 2, 1900 }, 6 },    { { 3840, 2 }, 0 },
    { { 100, 3000 }, 0 }, { { 3840, 2160 }, 0 },
};

/* The passes over what lattices left out: of a small picture in rounds, of a
 * large one in parts, twice, at first with a limit.  They show no colours, for
 * a tile's squares are all over the picture. */
LOOP_TEST(scattered_passes_come_last, N_ELEM(rests))
{
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_params par;
    uint32_t n, shown = 0, rest = 0, bounded = 0, rounds = rests[_i].rounds;

    rad_params_init(&par);
    par.ambounce = 2;
    n = rad_passes_plan(&par, &rests[_i].size, 1, pass);
    for (uint32_t i = 0; i < n; i++) {
        ck_assert(rest == 0 || pass[i].scattered);
        ck_assert(!pass[i].scattered || !rad_pass_shows(&pass[i]));
        shown += rad_pass_shows(&pass[i]);
        rest += pass[i].scattered;
        bounded += pass[i].scattered && pass[i].rays > 0;
    }
    ck_assert_uint_eq(rad_passes_ready(pass, n - 1), 0);
    ck_assert_uint_eq(rad_passes_ready(pass, n), 1);
    ck_assert_uint_gt(shown, 0);
    ck_assert_uint_eq(rest, rounds > 0 ? rounds : 2 * RAD_PASS_PARTS);
    ck_assert_uint_eq(bounded, rounds > 0 ? 0 : RAD_PASS_PARTS);
}

static void
see_tiles(const struct rad_pass *pass, int w, int h, uint8_t *seen)
{
    for (uint32_t i = 0; i < rad_pass_tiles(pass, w, h); i++) {
        struct rad_pass_area a = rad_pass_area(pass, w, h, i);

        ck_assert(a.x0 >= 0 && a.y0 >= 0 && a.x1 <= w && a.y1 <= h);
        ck_assert(a.x0 < a.x1 && a.y0 < a.y1);
        ck_assert(a.x0 % pass->step == 0 && a.y0 % pass->step == 0);
        for (int y = a.y0; y < a.y1; y++)
            for (int x = a.x0; x < a.x1; x++)
                seen[y * w + x]++;
    }
}

static bool
all_are(const uint8_t *seen, int n, int times)
{
    for (int i = 0; i < n; i++)
        if (seen[i] != times)
            return false;
    return true;
}

/* Count the squares of a tile.  Four or more of them spread over half of all
 * numbers. */
static void
see_squares(const struct rad_pass *pass, uint32_t tile, uint8_t *seen)
{
    uint32_t n = rad_pass_squares(pass, tile), low = UINT32_MAX, high = 0;

    ck_assert_uint_gt(n, 0);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = rad_pass_square(pass, tile, i);

        ck_assert_uint_lt(k, pass->squares);
        low = k < low ? k : low;
        high = k > high ? k : high;
        seen[k]++;
    }
    ck_assert(n < 4 || 2 * (high - low) > pass->squares);
}

/* Each square is in one tile of one round, or of each pass; the first frames of
 * many have rounds, too. */
LOOP_TEST(each_square_is_in_one_tile, N_ELEM(rests))
{
    enum { MOST = 1 << 19, FRAMES = 40 };
    static uint8_t seen[MOST];
    struct rad_pass_size size[FRAMES];
    struct rad_pass pass[RAD_MOST_PASSES];
    struct rad_params par;
    uint32_t n, seen_to = 0;

    rad_params_init(&par);
    par.ambounce = 2;
    for (int i = 0; i < FRAMES; i++)
        size[i] = rests[_i].size;
    n = rad_passes_plan(&par, size, FRAMES, pass);
    for (uint32_t i = 0; i < n; i++) {
        if (!pass[i].scattered)
            continue;
        ck_assert_uint_le(pass[i].squares, MOST);
        ck_assert_uint_eq(pass[i].first, seen_to);
        if (pass[i].first == 0)
            memset(seen, 0, sizeof seen);
        for (uint32_t tile = 0; tile < pass[i].tiles; tile++)
            see_squares(&pass[i], tile, seen);
        seen_to = pass[i].end;
        if (seen_to == pass[i].squares) {
            ck_assert(all_are(seen, (int)seen_to, 1));
            seen_to = 0;
        }
    }
    ck_assert_uint_eq(seen_to, 0);
}

/* Each pixel of a lattice lies in one tile, whatever the size; and with two
 * fields, of two tiles side by side each has one, and so with all parts of
 * each. */
TEST(tiles_are_the_picture)
{
    static const struct rad_pass_size size[] = { { 1, 1 },   { 64, 64 },
                                                 { 65, 1 },  { 1, 257 },
                                                 { 300, 7 }, { 511, 513 } };
    static uint8_t seen[511 * 513];

    for (size_t k = 0; k < N_ELEM(size); k++)
        for (int step = 2; step <= 32; step *= 2) {
            struct rad_pass pass = {
                .step = step, .side = 4, .part = -1, .field = -1
            };
            int w = size[k].width, h = size[k].height;

            memset(seen, 0, sizeof seen);
            see_tiles(&pass, w, h, seen);
            pass.field = 0;
            see_tiles(&pass, w, h, seen);
            for (int y = 0; y < h; y++)
                for (int x = 0; x < w; x++)
                    ck_assert_uint_eq(seen[y * w + x],
                                      2 - (x / (4 * step) + y / (4 * step)) %
                                              2);
            pass.field = 1;
            see_tiles(&pass, w, h, seen);
            ck_assert(all_are(seen, w * h, 2));
            for (pass.part = 0; pass.part < RAD_PASS_PARTS; pass.part++)
                for (pass.field = 0; pass.field < 2; pass.field++)
                    see_tiles(&pass, w, h, seen);
            ck_assert(all_are(seen, w * h, 3));
        }
}
