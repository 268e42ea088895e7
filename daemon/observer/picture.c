/* picture.c - see picture.h */
#include "config.h"

#include "observer/picture.h"

#include "base/bits.h"
#include "base/files.h"
#include "image/hdr.h"
#include "tone/screen.h"

#include <stdlib.h>
#include <string.h>

/* --- its header --- */

/* What follows a word in a line of the header, which an empty line ends; ""
 * where there is none, or it is too long. */
static void
find_line(const uint8_t *hdr, size_t len, const char *word,
          char text[PICTURE_VIEW])
{
    const uint8_t *end = memmem(hdr, len, "\n\n", 2), *at;
    size_t n = 0;

    text[0] = '\0';
    at = end ? memmem(hdr, (size_t)(end - hdr), word, strlen(word)) : NULL;
    if (!at)
        return;
    for (const uint8_t *next = at; next; at = next ? next : at)
        next = memmem(at + 1, (size_t)(end - at - 1), word, strlen(word));
    at += strlen(word);
    while (at < end && *at == ' ')
        at++;
    while (at + n < end && at[n] != '\n')
        n++;
    if (n >= PICTURE_VIEW)
        return;
    memcpy(text, at, n);
    text[n] = '\0';
}

/* --- its pixels --- */

static int
factor_of(int width, int height)
{
    int k = 1;

    while ((double)(width / k) * (height / k) > PICTURE_PIXELS &&
           width / (k + 1) > 0 && height / (k + 1) > 0)
        k++;
    return k;
}

/* Mean radiance of the pixels from column x, row y on, k by k of them. */
static struct rad_rgb
mean_of(const struct rad_coded_picture *c, int x, int y, int k)
{
    struct rad_rgb sum = rad_grey(0);

    if (k == 1)
        return rad_rgbe_radiance(
            c->rgbe + 4 * ((size_t)y * (size_t)c->width + (size_t)x));
    for (int j = 0; j < k; j++)
        for (int i = 0; i < k; i++) {
            size_t at = (size_t)(y + j) * (size_t)c->width + (size_t)(x + i);

            sum = rad_rgb_add(sum, rad_rgbe_radiance(c->rgbe + 4 * at));
        }
    return rad_rgb_scale(sum, 1 / (float)(k * k));
}

/* The pixels, coded and as radiance. */
static int
fill(struct picture *pic, const struct rad_coded_picture *c, struct rad_rgb *L)
{
    size_t n = (size_t)pic->width * (size_t)pic->height, at = 0;

    pic->nrgbe = PICTURE_HEAD + 4 * n;
    pic->rgbe = malloc(pic->nrgbe);
    if (!pic->rgbe)
        return RAD_ENOMEM;
    memcpy(pic->rgbe, "RWP1", 4);
    rad_store_be(pic->rgbe + 4, (uint32_t)pic->width, 4);
    rad_store_be(pic->rgbe + 8, (uint32_t)pic->height, 4);
    rad_store_be(pic->rgbe + 12, (uint32_t)pic->factor, 4);
    if (pic->factor == 1) /* to the bit */
        memcpy(pic->rgbe + PICTURE_HEAD, c->rgbe, 4 * n);
    for (int y = 0; y < pic->height; y++)
        for (int x = 0; x < pic->width; x++, at++) {
            L[at] = mean_of(c, x * pic->factor, y * pic->factor, pic->factor);
            if (pic->factor > 1)
                rad_rgbe(L[at], pic->rgbe + PICTURE_HEAD + 4 * at);
        }
    return 0;
}

/* --- for a screen --- */

static int
make_png(struct picture *pic, const struct rad_picture *whole, bool partial,
         struct rad_error *err)
{
    struct rad_memory_out png;
    const struct rad_sink sink = rad_memory_sink(&png);
    struct rad_tone tone = { 0 };
    struct rad_screen screen;
    int rc;

    rad_screen_init(&screen);
    screen.tone.partial = partial;
    rc = rad_screen_png(&screen, &tone, whole, NULL, &sink, err);
    if (rc < 0) {
        free(png.bytes);
        return rc;
    }
    pic->png = png.bytes;
    pic->npng = png.len;
    return 0;
}

/* --- public --- */

static int
make_both(struct picture *pic, const struct rad_coded_picture *c,
          const uint8_t *hdr, size_t len, bool partial, struct rad_error *err)
{
    struct rad_picture whole = { .pixaspect = c->pixaspect };
    int rc;

    pic->factor = factor_of(c->width, c->height);
    pic->width = whole.width = c->width / pic->factor;
    pic->height = whole.height = c->height / pic->factor;
    whole.L =
        malloc((size_t)pic->width * (size_t)pic->height * sizeof *whole.L);
    rc = whole.L ? fill(pic, c, whole.L) : RAD_ENOMEM;
    if (rc == 0 && pic->factor == 1)
        rc = rad_edges_read(hdr, len, pic->width, pic->height, &whole.edges,
                            NULL);
    if (rc == 0)
        rc = make_png(pic, &whole, partial, err);
    else
        rad_fail(err, rc, "out of memory");
    rad_picture_release(&whole);
    return rc;
}

int
picture_make(struct picture *pic, const uint8_t *hdr, size_t len, bool partial,
             struct rad_error *err)
{
    struct rad_coded_picture coded;
    int rc;

    *pic = (struct picture){ 0 };
    rc = rad_hdr_read_coded(hdr, len, PICTURE_MOST, &coded, err);
    if (rc < 0)
        return rc;
    find_line(hdr, len, "\nVIEW=", pic->view);
    find_line(hdr, len, "\nSCENE=", pic->scene);
    rc = make_both(pic, &coded, hdr, len, partial, err);
    rad_coded_picture_release(&coded);
    if (rc < 0)
        picture_release(pic);
    return rc;
}

void
picture_release(struct picture *pic)
{
    free(pic->rgbe);
    free(pic->png);
    *pic = (struct picture){ 0 };
}
