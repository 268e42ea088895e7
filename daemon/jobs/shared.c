/* shared.c - see shared.h
 *
 * Memory is allocated for a frame when the first fact, guess or piece of a base
 * line of it comes. */
#include "config.h"

#include "jobs/shared.h"

#include "machine/shelf.h"
#include "team/team.h"

#include "picture/quincunx.h"

#include <stdlib.h>
#include <string.h>

struct shared_facts {
    struct shared_facts *next;
    struct msg_facts m; /* its pointers lead into .bytes */
    size_t len;
    uint8_t bytes[];
};

struct line {
    struct shared_facts *facts, **end; /* end: NULL while there are none */
    uint8_t *seen;      /* bitmap of the line's pixels whose facts came; NULL:
                         * no facts came */
    uint8_t *guess;     /* the densities after the line; NULL: none came */
    uint8_t known;      /* how many lines the guess follows from */
    struct shelf shelf; /* the base line, as far as it came */
    uint64_t whole_ms;  /* when the base line became whole; 0: not yet */
};

struct frame {
    struct rad_quincunx q;
    uint32_t ndensity;
    struct line *line; /* NULL: nothing is kept of the frame */
};

struct shared {
    struct frame *frame;
    uint32_t nframes;
    uint8_t channels;
    size_t facts_bytes;
};

struct shared *
shared_new(const struct msg_frame *frames, uint32_t nframes, int psample,
           uint8_t channels)
{
    struct shared *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    s->frame = calloc(nframes, sizeof *s->frame);
    if (!s->frame) {
        free(s);
        return NULL;
    }
    s->nframes = nframes;
    s->channels = channels;
    for (uint32_t i = 0; i < nframes; i++) {
        struct rad_quincunx *q = &s->frame[i].q;

        q->width = (int)frames[i].width;
        q->height = (int)frames[i].height;
        rad_quincunx_steps(psample, &q->xstep, &q->ystep);
        s->frame[i].ndensity = (uint32_t)rad_quincunx_ndensity(q);
    }
    return s;
}

void
shared_free(struct shared *s)
{
    if (!s)
        return;
    for (uint32_t i = 0; i < s->nframes; i++)
        shared_drop_frame(s, i);
    free(s->frame);
    free(s);
}

uint32_t
shared_nlines(const struct shared *s, uint32_t frame)
{
    return (uint32_t)rad_quincunx_nbases(&s->frame[frame].q);
}

/* The line, made if need be; NULL when memory is out. */
static struct line *
make_line(struct shared *s, uint32_t frame, uint32_t line)
{
    struct frame *f = &s->frame[frame];

    if (!f->line)
        f->line = calloc((size_t)rad_quincunx_nbases(&f->q), sizeof *f->line);
    return f->line ? &f->line[line] : NULL;
}

/* The line; NULL: nothing is kept of its frame. */
static struct line *
find_line(const struct shared *s, uint32_t frame, uint32_t line)
{
    struct frame *f = &s->frame[frame];

    return f->line ? &f->line[line] : NULL;
}

/* Is there such a line, and have the frames that many channels? */
static bool
fits(const struct shared *s, uint32_t frame, uint32_t line, uint8_t channels)
{
    return frame < s->nframes && channels == s->channels &&
           line < shared_nlines(s, frame);
}

/* --- facts --- */

/* Rows of a line: its base line and the bar above. */
static uint32_t
rows_of(const struct rad_quincunx *q, uint32_t line)
{
    int row = rad_quincunx_base_row(q, (int)line);

    return line == 0
               ? 1
               : (uint32_t)(row - rad_quincunx_base_row(q, (int)line - 1));
}

bool
shared_facts_fit(const struct shared *s, const struct msg_facts *m)
{
    const struct rad_quincunx *q;

    if (!fits(s, m->frame, m->line, m->channels))
        return false;
    q = &s->frame[m->frame].q;
    return m->width == (uint32_t)q->width &&
           m->row + m->rows <= rows_of(q, m->line);
}

bool
shared_loan_fits(const struct shared *s, const struct msg_loan *m)
{
    const struct frame *f;

    if (!fits(s, m->frame, m->line, m->channels) || m->line < 1)
        return false;
    f = &s->frame[m->frame];
    return m->ndensity == (m->flags & MSG_LOAN_LINE ? f->ndensity : 0) &&
           team_blocks_of(&f->q, (int)m->x, (int)m->n) != 0;
}

bool
shared_of_base(const struct shared *s, const struct msg_facts *m)
{
    return !(m->flags & MSG_FACTS_ESTIMATE) &&
           m->row + m->rows == rows_of(&s->frame[m->frame].q, m->line);
}

/* Mark the facts' pixels as seen; returns how many of them were marked before.
 */
static uint32_t
see(struct shared *s, struct line *l, const struct msg_facts *m)
{
    size_t stride = (m->width + 7) / 8, first = m->row * stride;
    uint32_t n = 0;

    if (!l->seen)
        l->seen = calloc(rows_of(&s->frame[m->frame].q, m->line), stride);
    for (size_t i = 0; l->seen && i < m->rows * stride; i++) {
        for (unsigned b = l->seen[first + i] & m->bitmap[i]; b; b &= b - 1)
            n++;
        l->seen[first + i] |= m->bitmap[i];
    }
    return n;
}

uint32_t
shared_put_facts(struct shared *s, const struct msg_facts *m)
{
    struct line *l = make_line(s, m->frame, m->line);
    uint32_t again = l && !(m->flags & MSG_FACTS_ESTIMATE) ? see(s, l, m) : 0;
    size_t bitmap = (size_t)m->rows * ((m->width + 7) / 8);
    size_t pixels = (size_t)m->npixels * m->channels * 4;
    size_t len = sizeof(struct shared_facts) + bitmap + pixels;
    struct shared_facts *f;

    if (!l || m->npixels == 0 || len > SHARED_MAX_FACTS - s->facts_bytes ||
        !(f = malloc(len)))
        return again;
    memcpy(f->bytes, m->bitmap, bitmap);
    memcpy(f->bytes + bitmap, m->pixels, pixels);
    f->m = *m;
    f->m.job = NULL;
    f->m.bitmap = f->bytes;
    f->m.pixels = f->bytes + bitmap;
    f->len = len;
    f->next = NULL;
    if (l->end)
        *l->end = f;
    else
        l->facts = f;
    l->end = &f->next;
    s->facts_bytes += len;
    return again;
}

bool
shared_get_facts(const struct shared *s, uint32_t frame, uint32_t line,
                 const struct shared_facts **at, struct msg_facts *m)
{
    const struct line *l = find_line(s, frame, line);

    *at = *at ? (*at)->next : l ? l->facts : NULL;
    if (!*at)
        return false;
    *m = (*at)->m;
    return true;
}

bool
shared_guess_fits(const struct shared *s, const struct msg_guess *m)
{
    return m->frame < s->nframes && m->line < shared_nlines(s, m->frame) - 1 &&
           m->ndensity == s->frame[m->frame].ndensity;
}

bool
shared_put_guess(struct shared *s, const struct msg_guess *m)
{
    struct line *l = make_line(s, m->frame, m->line);

    if (!l || m->known <= l->known)
        return false;
    if (!l->guess && !(l->guess = malloc(m->ndensity + 1)))
        return false;
    memcpy(l->guess, m->density, m->ndensity);
    l->known = m->known;
    return true;
}

bool
shared_get_guess(const struct shared *s, uint32_t frame, uint32_t line,
                 struct msg_guess *m)
{
    const struct line *l = find_line(s, frame, line);

    if (!l || !l->guess)
        return false;
    *m = (struct msg_guess){ .frame = frame,
                             .line = line,
                             .known = l->known,
                             .ndensity = s->frame[frame].ndensity,
                             .density = l->guess };
    return true;
}

static void
drop_facts(struct shared *s, struct line *l)
{
    for (struct shared_facts *f = l->facts, *next; f; f = next) {
        next = f->next;
        s->facts_bytes -= f->len;
        free(f);
    }
    free(l->seen);
    free(l->guess);
    l->seen = NULL;
    l->guess = NULL;
    l->known = 0;
    l->facts = NULL;
    l->end = NULL;
}

void
shared_drop_facts(struct shared *s, uint32_t frame, uint32_t line)
{
    struct line *l = find_line(s, frame, line);

    if (l)
        drop_facts(s, l);
}

/* --- base lines --- */

static struct shelf_size
size_of(const struct shared *s, uint32_t frame)
{
    const struct frame *f = &s->frame[frame];

    return (struct shelf_size){ (uint32_t)f->q.width, f->ndensity,
                                s->channels };
}

bool
shared_base_fits(const struct shared *s, const struct msg_base_line *m)
{
    struct shelf_size size;

    if (!fits(s, m->frame, m->line, m->channels))
        return false;
    size = size_of(s, m->frame);
    return shelf_fits(&size, m);
}

bool
shared_put_base(struct shared *s, const struct msg_base_line *m,
                uint64_t now_ms)
{
    struct line *l = make_line(s, m->frame, m->line);
    struct shelf_size size = size_of(s, m->frame);

    if (!l || l->whole_ms != 0 || shelf_put(&l->shelf, m) != 0 ||
        !shelf_is_whole(&l->shelf, &size))
        return false;
    l->whole_ms = now_ms ? now_ms : 1;
    return true;
}

bool
shared_get_base(const struct shared *s, uint32_t frame, uint32_t line,
                uint32_t *x, uint32_t *first, struct msg_base_line *m)
{
    const struct line *l = find_line(s, frame, line);

    *m = (struct msg_base_line){ .frame = frame, .line = line };
    return l && shelf_piece(&l->shelf, x, first, m);
}

uint32_t
shared_ndensity(const struct shared *s, uint32_t frame)
{
    return s->frame[frame].ndensity;
}

const uint8_t *
shared_densities(const struct shared *s, uint32_t frame, uint32_t line)
{
    const struct line *l = find_line(s, frame, line);

    return l && l->whole_ms != 0 ? l->shelf.density : NULL;
}

const uint8_t *
shared_pixels(const struct shared *s, uint32_t frame, uint32_t line)
{
    const struct line *l = find_line(s, frame, line);

    return l && l->whole_ms != 0 ? l->shelf.pixels : NULL;
}

uint64_t
shared_whole_ms(const struct shared *s, uint32_t frame, uint32_t line)
{
    const struct line *l = find_line(s, frame, line);

    return l ? l->whole_ms : 0;
}

static void
drop_base(struct line *l)
{
    shelf_clear(&l->shelf);
    l->whole_ms = 0;
}

void
shared_drop_base(struct shared *s, uint32_t frame, uint32_t line)
{
    struct line *l = find_line(s, frame, line);

    if (l)
        drop_base(l);
}

void
shared_drop_frame(struct shared *s, uint32_t frame)
{
    struct frame *f = &s->frame[frame];
    int n = f->line ? rad_quincunx_nbases(&f->q) : 0;

    for (int i = 0; i < n; i++) {
        drop_facts(s, &f->line[i]);
        drop_base(&f->line[i]);
    }
    free(f->line);
    f->line = NULL;
}
