/* screen.c - see screen.h */
#include "config.h"

#include "tone/screen.h"

#include "image/png.h"
#include "image/srgb.h"

#include <stdlib.h>
#include <string.h>

void
rad_screen_init(struct rad_screen *s)
{
    memset(s, 0, sizeof *s);
    s->tone.curve = RAD_TONE_PHOTOGRAPHIC;
    s->tone.exposure = 1;
    s->bits = 8;
}

struct shown {
    struct rad_toner toner;
    struct rad_srgb_table srgb;
    struct rad_rgb *row;
    int bits;
};

static uint8_t *
put(const struct shown *s, float linear, uint8_t *out)
{
    float v = rad_srgb_encode(&s->srgb, linear);

    if (s->bits == 16) {
        unsigned n = (unsigned)(v * 65535 + .5f);

        *out++ = (uint8_t)(n >> 8);
        *out++ = (uint8_t)n;
    } else {
        *out++ = (uint8_t)(v * 255 + .5f);
    }
    return out;
}

static void
put_row(void *arg, int y, uint8_t *out)
{
    struct shown *s = arg;

    rad_toner_row(&s->toner, y, s->row);
    for (int x = 0; x < s->toner.pic->width; x++) {
        out = put(s, s->row[x].r, out);
        out = put(s, s->row[x].g, out);
        out = put(s, s->row[x].b, out);
    }
}

int
rad_screen_png(const struct rad_screen *s, struct rad_tone *tone,
               const struct rad_picture *pic, const struct rad_view *view,
               const struct rad_sink *sink, struct rad_error *err)
{
    struct rad_png png = { pic->width, pic->height, s->bits, pic->pixaspect };
    struct shown *shown = calloc(1, sizeof *shown);
    int rc;

    if (!shown)
        return rad_fail_memory(err);
    shown->bits = s->bits;
    rad_srgb_init(&shown->srgb);
    shown->row = malloc((size_t)pic->width * sizeof *shown->row);
    rc = shown->row
             ? rad_toner_init(&shown->toner, &s->tone, tone, pic, view, err)
             : rad_fail_memory(err);
    if (rc == 0)
        rc = rad_png_rows(&png, put_row, shown, sink, err);
    rad_toner_release(&shown->toner);
    free(shown->row);
    free(shown);
    return rc;
}
