/* check_show.c - how clients choose tones, for pictures, previews and frames */
#include "config.h"

#include "show/show.h"

#include "tests/made_picture.h"

#include <string.h>

static const struct {
    const char *text;
    bool good, each, absolute;
    double exposure;
} words[] = {
    { "auto", true, false, false, 1 },
    { "+1", true, false, false, 2 },
    { "-2", true, false, false, .25 },
    { "+.5", true, false, false, 1.4142135623730951 },
    { "+0", true, false, false, 1 },
    { "2", true, false, true, 2 },
    { "1e-3", true, false, true, 1e-3 },
    { "first", true, false, false, 1 },
    { "each", true, true, false, 1 },
    { "each,auto", true, true, false, 1 },
    { "each,+1", true, true, false, 2 },
    { "first,.25", true, false, true, .25 },
    { "", false, false, false, 0 },
    { "0", false, false, false, 0 },
    { "+", false, false, false, 0 },
    { "+-1", false, false, false, 0 },
    { "-+1", false, false, false, 0 },
    { "+41", false, false, false, 0 },
    { "-41", false, false, false, 0 },
    { "nan", false, false, false, 0 },
    { "+nan", false, false, false, 0 },
    { "inf", false, false, false, 0 },
    { "1e13", false, false, false, 0 },
    { "1e-13", false, false, false, 0 },
    { "each,", false, false, false, 0 },
    { "eachauto", false, false, false, 0 },
    { "each,first", false, false, false, 0 },
    { "auto,each", false, false, false, 0 },
    { "1 ", false, false, false, 0 },
    { "Auto", false, false, false, 0 },
};

LOOP_TEST(exposure_is_read_or_refused, N_ELEM(words))
{
    struct rad_error err = { 0 };
    struct show s;

    show_init(&s);
    ck_assert_int_eq(show_exposure(&s, words[_i].text, &err),
                     words[_i].good ? 0 : RAD_EUSAGE);
    if (!words[_i].good) {
        ck_assert_ptr_nonnull(strstr(err.what, "--exposure"));
        return;
    }
    ck_assert(s.each == words[_i].each);
    ck_assert(s.screen.tone.absolute == words[_i].absolute);
    ck_assert_double_eq_tol(s.screen.tone.exposure, words[_i].exposure, 1e-12);
}

TEST(tones_and_bits_are_words)
{
    struct show s;

    show_init(&s);
    ck_assert_int_eq(s.screen.tone.curve, RAD_TONE_PHOTOGRAPHIC);
    ck_assert_int_eq(s.screen.bits, 8);
    ck_assert_int_eq(show_tone(&s, "human", NULL), 0);
    ck_assert_int_eq(s.screen.tone.curve, RAD_TONE_HUMAN);
    ck_assert_int_eq(show_tone(&s, "linear", NULL), 0);
    ck_assert_int_eq(s.screen.tone.curve, RAD_TONE_LINEAR);
    ck_assert_int_eq(show_tone(&s, "photographic", NULL), 0);
    ck_assert_int_eq(s.screen.tone.curve, RAD_TONE_PHOTOGRAPHIC);
    ck_assert_int_eq(show_tone(&s, "photo", NULL), RAD_EUSAGE);
    ck_assert_int_eq(show_bits(&s, "16", NULL), 0);
    ck_assert_int_eq(s.screen.bits, 16);
    ck_assert_int_eq(show_bits(&s, "8", NULL), 0);
    ck_assert_int_eq(s.screen.bits, 8);
    ck_assert_int_eq(show_bits(&s, "12", NULL), RAD_EUSAGE);
}

static int
ignore(void *arg, const void *data, size_t n, struct rad_error *err)
{
    (void)arg;
    (void)data;
    (void)n;
    (void)err;
    return 0;
}

/* The scale that a preview of so many rows of 40 has. */
static double
previewed(const struct show *s, struct show_last *last, int rows)
{
    struct rad_sink sink = { ignore, NULL };
    struct rad_picture p = blank(40, 40);

    for (int i = 0; i < 40 * rows; i++)
        p.L[i] = rad_grey(1.f + (float)(i / 40));
    ck_assert_int_eq(show_preview(s, last, &p, NULL, &sink, NULL), 0);
    rad_picture_release(&p);
    return last->tone.scale;
}

TEST(previews_do_not_flicker)
{
    struct show_last last = { 0 };
    struct show s;
    double scale;

    show_init(&s);
    scale = previewed(&s, &last, 5);
    ck_assert_double_eq(previewed(&s, &last, 6), scale);
    ck_assert_double_eq(previewed(&s, &last, 9), scale);
    ck_assert_double_lt(previewed(&s, &last, 10), scale);
    scale = previewed(&s, &last, 19);
    ck_assert_double_lt(previewed(&s, &last, 40), scale);
    ck_assert(!s.tone.fitted);
    s.tone = last.tone; /* the first frame is whole */
    s.tone.scale = 5;
    memset(&last, 0, sizeof last);
    ck_assert_double_eq(previewed(&s, &last, 3), 5);
    s.each = true;
    ck_assert_double_lt(previewed(&s, &last, 40), 1);
}

static double
shown_scale(struct show *s, float L)
{
    struct rad_sink sink = { ignore, NULL };
    struct rad_picture p = blank(2, 2);

    for (int i = 0; i < 4; i++)
        p.L[i] = rad_grey(L);
    ck_assert_int_eq(show_picture(s, &p, NULL, &sink, NULL), 0);
    rad_picture_release(&p);
    return s->tone.scale;
}

/* 1 over the exposure, which is .25 of the average. */
TEST(frames_have_the_first_ones_exposure_or_their_own)
{
    struct show s;

    show_init(&s);
    ck_assert(show_waits(&s));
    shown_scale(&s, 0); /* a black frame says nothing */
    ck_assert(show_waits(&s));
    ck_assert_double_eq_tol(shown_scale(&s, 1), .25, 1e-6);
    ck_assert(!show_waits(&s));
    ck_assert_double_eq_tol(shown_scale(&s, 4), .25, 1e-6);
    show_init(&s);
    ck_assert_int_eq(show_exposure(&s, "each", NULL), 0);
    ck_assert(!show_waits(&s));
    ck_assert_double_eq_tol(shown_scale(&s, 1), .25, 1e-6);
    ck_assert_double_eq_tol(shown_scale(&s, 4), .0625, 1e-6);
    show_init(&s);
    ck_assert_int_eq(show_exposure(&s, "3", NULL), 0);
    ck_assert(!show_waits(&s));
    ck_assert_double_eq_tol(shown_scale(&s, 4), 3, 1e-6);
}

static const struct {
    struct show_asked asked;
    const char *first;
    bool fits;
} asked[] = {
    { { .tone = false }, NULL, true },
    { { .bits = true, .exposure = "auto" }, "--exposure", true },
    { { .bits = true, .tone = true }, "--tone", true },
    { { .false_colour = "" }, "--false-colour", true },
    { { .false_colour = "", .bits = true }, "--false-colour", false },
    { { .false_colour = "", .exposure = "auto" }, "--false-colour", false },
};

LOOP_TEST(false_colours_have_no_tone, N_ELEM(asked))
{
    struct rad_error err = { 0 };
    const char *first;

    ck_assert_int_eq(show_first(&asked[_i].asked, &first, &err),
                     asked[_i].fits ? 0 : RAD_EUSAGE);
    ck_assert_pstr_eq(first, asked[_i].first);
}
