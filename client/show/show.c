/* show.c - see show.h */
#include "config.h"

#include "show/show.h"

#include "common/words.h"

#include "base/number.h"
#include "image/png.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_STOPS  40
#define MOST_FACTOR 1e12

void
show_init(struct show *s)
{
    memset(s, 0, sizeof *s);
    rad_screen_init(&s->screen);
}

/* Take the word at *text, with a comma that follows it; false: another word, or
 * other characters follow. */
static bool
take_word(const char **text, const char *word)
{
    size_t n = strlen(word);

    if (strncmp(*text, word, n) != 0 ||
        ((*text)[n] != '\0' && (*text)[n] != ','))
        return false;
    *text += n + ((*text)[n] == ',' && (*text)[n + 1] != '\0');
    return true;
}

static bool
take_value(struct rad_tone_options *o, const char *text)
{
    bool stops = text[0] == '+' || text[0] == '-';
    double v;

    if (strcmp(text, "auto") == 0)
        return true;
    /* "+-1" is malformed */
    if ((stops && strchr("+-", text[1])) ||
        !rad_parse_real(text + (text[0] == '+'), &v))
        return false;
    o->absolute = !stops;
    o->exposure = stops ? exp2(v) : v;
    return stops ? fabs(v) <= MOST_STOPS
                 : v >= 1 / MOST_FACTOR && v <= MOST_FACTOR;
}

int
show_exposure(struct show *s, const char *text, struct rad_error *err)
{
    const char *at = text;
    bool first = take_word(&at, "first");

    s->each = !first && take_word(&at, "each");
    if (((first || s->each) && at[0] == '\0') ||
        take_value(&s->screen.tone, at))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "option '--exposure': '%.40s' is not auto, +STOPS or "
                    "-STOPS (up to %d), or a FACTOR from 1e-12 to 1e12, alone "
                    "or behind 'first,' or 'each,'",
                    text, MOST_STOPS);
}

int
show_tone(struct show *s, const char *word, struct rad_error *err)
{
    int i = words_place(SHOW_TONES, word);

    if (i < 0)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--tone': '%.40s' is none of %s", word,
                        SHOW_TONES);
    s->screen.tone.curve = (enum rad_tone_curve)i;
    return 0;
}

int
show_bits(struct show *s, const char *word, struct rad_error *err)
{
    int i = words_place(SHOW_BITS, word);

    if (i < 0)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--bits': '%.40s' is none of %s", word,
                        SHOW_BITS);
    s->screen.bits = i == SHOW_16_BITS ? 16 : 8;
    return 0;
}

/* --false-colour=SCALE, as rad_false_parse() has it.  RAD_EUSAGE. */
static int
show_false(struct show *s, const char *scale, struct rad_error *err)
{
    struct rad_error why = { 0 };

    s->false_colour = true;
    if (rad_false_parse(&s->scale, scale, &why) == 0)
        return 0;
    return rad_fail(err, RAD_EUSAGE, "option '--false-colour': %s", why.what);
}

int
show_first(const struct show_asked *a, const char **name, struct rad_error *err)
{
    const char *given = a->tone       ? "--tone"
                        : a->exposure ? "--exposure"
                        : a->bits     ? "--bits"
                                      : NULL;

    *name = a->false_colour ? "--false-colour" : given;
    if (given && a->false_colour)
        return rad_fail(err, RAD_EUSAGE,
                        "%s is no matter of --false-colour: leave one of them "
                        "out",
                        given);
    return 0;
}

int
show_take(struct show *s, const struct show_asked *a, struct rad_error *err)
{
    if (a->false_colour)
        return show_false(s, a->false_colour, err);
    return a->exposure ? show_exposure(s, a->exposure, err) : 0;
}

static int
false_png(const struct rad_false_scale *scale, const struct rad_picture *pic,
          const struct rad_sink *sink, struct rad_error *err)
{
    struct rad_image image = { 0 };
    int rc = rad_false_colour(scale, pic, &image, err);

    if (rc == 0)
        rc = rad_png_write(image.rgb, image.width, image.height,
                           pic->pixaspect, sink, err);
    free(image.rgb);
    return rc;
}

static void
fit_scale(struct show *s, const struct rad_picture *pic)
{
    if (!s->scaled)
        s->scaled = rad_false_fit(&s->scale, pic);
}

bool
show_waits(const struct show *s)
{
    if (s->false_colour)
        return !s->scaled && s->scale.top == 0;
    return !s->each && !s->tone.fitted && rad_tone_looks(&s->screen.tone);
}

int
show_fit(struct show *s, const struct rad_picture *pic,
         const struct rad_view *view, struct rad_error *err)
{
    struct rad_toner toner;
    int rc;

    if (s->false_colour) {
        fit_scale(s, pic);
        return 0;
    }
    rc = rad_toner_init(&toner, &s->screen.tone, &s->tone, pic, view, err);

    rad_toner_release(&toner);
    return rc;
}

int
show_picture(struct show *s, const struct rad_picture *pic,
             const struct rad_view *view, const struct rad_sink *sink,
             struct rad_error *err)
{
    if (s->false_colour) {
        fit_scale(s, pic);
        return false_png(&s->scale, pic, sink, err);
    }
    if (s->each)
        s->tone.fitted = false;
    return rad_screen_png(&s->screen, &s->tone, pic, view, sink, err);
}

static size_t
lit_pixels(const struct rad_picture *pic)
{
    size_t n = rad_picture_pixels(pic), lit = 0;

    for (size_t i = 0; i < n; i++)
        lit += !rad_rgb_black(pic->L[i]);
    return lit;
}

int
show_preview(const struct show *s, struct show_last *last,
             const struct rad_picture *pic, const struct rad_view *view,
             const struct rad_sink *sink, struct rad_error *err)
{
    size_t all = rad_picture_pixels(pic);
    size_t lit = lit_pixels(pic);
    struct rad_screen screen = s->screen;

    if (s->false_colour) {
        if (s->scaled || lit >= 2 * last->seen || lit == all) {
            last->scale = s->scale;
            last->seen = lit;
            rad_false_fit(&last->scale, pic);
        }
        return false_png(&last->scale, pic, sink, err);
    }
    screen.tone.partial = true;
    if (s->tone.fitted && !s->each) {
        last->tone = s->tone;
    } else if (lit >= 2 * last->seen || lit == all) {
        last->tone.fitted = false;
        last->seen = lit;
    }
    return rad_screen_png(&screen, &last->tone, pic, view, sink, err);
}
