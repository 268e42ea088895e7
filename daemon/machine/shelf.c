/* shelf.c - see shelf.h */
#include "config.h"

#include "machine/shelf.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>

#define MOST_COLUMNS 16384 /* in one BASE_LINE */

bool
shelf_fits(const struct shelf_size *of, const struct msg_base_line *m)
{
    return m->channels == of->channels && m->x <= of->width &&
           m->n <= of->width - m->x && m->first <= of->ndensity &&
           m->ndensity <= of->ndensity - m->first;
}

/* Make room for n bytes; false: memory is out. */
static bool
grow(uint8_t **v, size_t *room, size_t n)
{
    uint8_t *p;

    if (n <= *room)
        return true;
    n = n < 2 * *room ? 2 * *room : n;
    p = realloc(*v, n);
    if (!p)
        return false;
    *v = p;
    *room = n;
    return true;
}

int
shelf_put(struct shelf *s, const struct msg_base_line *m)
{
    uint32_t nx = m->x + m->n, nd = m->first + m->ndensity;
    size_t pixel = m->channels * sizeof(float);

    if (m->x > s->nx || m->first > s->nd ||
        (s->channels != 0 && s->channels != m->channels))
        return 0;
    if (!grow(&s->pixels, &s->pixels_room, nx * pixel) ||
        !grow(&s->density, &s->density_room, nd))
        return RAD_ENOMEM;
    s->channels = m->channels;
    if (m->n > 0)
        memcpy(s->pixels + m->x * pixel, m->pixels, m->n * pixel);
    if (m->ndensity > 0)
        memcpy(s->density + m->first, m->density, m->ndensity);
    s->nx = nx > s->nx ? nx : s->nx;
    s->nd = nd > s->nd ? nd : s->nd;
    return 0;
}

bool
shelf_is_whole(const struct shelf *s, const struct shelf_size *of)
{
    return s->channels == of->channels && s->nx == of->width &&
           s->nd == of->ndensity;
}

bool
shelf_piece(const struct shelf *s, uint32_t *x, uint32_t *first,
            struct msg_base_line *m)
{
    static const uint8_t none[1];
    uint32_t left = s->nx - *x, n = left < MOST_COLUMNS ? left : MOST_COLUMNS;

    if (n == 0 && *first == s->nd)
        return false;
    m->x = *x;
    m->n = n;
    m->first = *first;
    m->ndensity = s->nd - *first;
    m->channels = s->channels;
    m->density = m->ndensity > 0 ? s->density + *first : none;
    m->pixels =
        n > 0 ? s->pixels + (size_t)*x * s->channels * sizeof(float) : none;
    *x += n;
    *first = s->nd;
    return true;
}

size_t
shelf_bytes(const struct shelf *s)
{
    return s->pixels_room + s->density_room;
}

void
shelf_clear(struct shelf *s)
{
    free(s->pixels);
    free(s->density);
    *s = (struct shelf){ 0 };
}
