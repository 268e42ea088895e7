/* font.c - see font.h
 *
 * A line is set by its gaps: gap[i] is the distance from the start of letter
 * i-1 to the start of letter i, gap[0] comes before the first, gap[n] after the
 * last. */
#include "config.h"

#include "scene/file/font.h"

#include <ctype.h>
#include <string.h>

#define CELL 255
/* The most letters in a line, so that its width is far below INT32_MAX. */
#define MAX_LINE 100000
/* With proportional spacing, so many spaces in a row end a column. */
#define COLUMN_SPACES 3

/* A font file being read. */
struct reader {
    const char *p, *end;
    int line;
};

/* Skip white space and comments. */
static void
skip_space(struct reader *in)
{
    while (in->p < in->end &&
           (isspace((unsigned char)*in->p) || *in->p == '#')) {
        if (*in->p == '#')
            while (in->p < in->end && *in->p != '\n')
                in->p++;
        else if (*in->p++ == '\n')
            in->line++;
    }
}

/* Read the next integer.  1: found, 0: end of the text, negative: no number. */
static int
next_int(struct reader *in, int *value)
{
    int digits = 0, sign = 1, v = 0;

    skip_space(in);
    if (in->p == in->end)
        return 0;
    if (*in->p == '-' || *in->p == '+')
        sign = *in->p++ == '-' ? -1 : 1;
    while (in->p < in->end && isdigit((unsigned char)*in->p)) {
        if (++digits > 8)
            return RAD_EDATA;
        v = v * 10 + (*in->p++ - '0');
    }
    if (digits == 0 ||
        (in->p < in->end && !isspace((unsigned char)*in->p) && *in->p != '#'))
        return RAD_EDATA;
    *value = sign * v;
    return 1;
}

static void
extend(uint8_t *lo, uint8_t *hi, int v)
{
    if (v < *lo)
        *lo = (uint8_t)v;
    if (v > *hi)
        *hi = (uint8_t)v;
}

static int
read_vertices(struct reader *in, struct rad_glyph *g, int code,
              struct rad_error *err)
{
    int v;

    for (int i = 0; i < 2 * g->nverts; i++) {
        if (next_int(in, &v) <= 0 || v < 0 || v > 255)
            return rad_fail(err, RAD_EDATA,
                            "line %d: bad vertex of character %d", in->line,
                            code);
        g->vert[i / 2][i % 2] = (uint8_t)v;
        if (i % 2 == 0)
            extend(&g->left, &g->right, v);
        else
            extend(&g->bottom, &g->top, v);
    }
    return 0;
}

static int
read_glyph(struct reader *in, struct rad_font *font, struct rad_arena *arena,
           int code, struct rad_error *err)
{
    struct rad_glyph *g;
    int n;

    if (code < 1 || code > 255 || font->glyph[code])
        return rad_fail(err, RAD_EDATA, "line %d: %s character %d", in->line,
                        code < 1 || code > 255 ? "illegal" : "duplicate", code);
    if (next_int(in, &n) <= 0 || n < 0 || n > RAD_FONT_MAX_VERTS)
        return rad_fail(err, RAD_EDATA,
                        "line %d: bad number of vertices for character %d",
                        in->line, code);
    g = rad_arena_alloc(arena, sizeof *g);
    if (!g || !(g->vert = rad_arena_alloc(arena, (size_t)n * 2)))
        return rad_fail_memory(err);
    g->nverts = n;
    g->left = g->right = g->bottom = g->top = 128;
    font->glyph[code] = g;
    return read_vertices(in, g, code, err);
}

struct rad_font *
rad_font_parse(struct rad_arena *arena, const char *text, size_t len,
               struct rad_error *err)
{
    struct reader in = { text, text + len, 1 };
    struct rad_font *font = rad_arena_calloc(arena, 1, sizeof *font);
    int code, got, sum = 0, n = 0;

    if (!font) {
        rad_fail_memory(err);
        return NULL;
    }
    while ((got = next_int(&in, &code)) > 0) {
        const struct rad_glyph *g;

        if (read_glyph(&in, font, arena, code, err) < 0)
            return NULL;
        g = font->glyph[code];
        if (g->right > g->left && g->top > g->bottom) {
            sum += g->right - g->left;
            n++;
        }
    }
    if (got < 0) {
        rad_fail(err, RAD_EDATA, "line %d: expected an integer", in.line);
        return NULL;
    }
    font->mean_width = n ? sum / n : 0;
    return font;
}

/* Even-odd rule: count the edges that a ray toward +x crosses.  An edge is
 * computed from its lower end, whatever its direction, so that the two edges of
 * a seam agree. */
bool
rad_glyph_inside(const struct rad_glyph *g, double x, double y)
{
    const uint8_t *a, *b;
    bool in = false;

    if (x < g->left || x >= g->right || y < g->bottom || y >= g->top)
        return false;
    if (g->nverts == 0)
        return false;
    a = g->vert[g->nverts - 1];
    for (int i = 0; i < g->nverts; i++, a = b) {
        const uint8_t *lo, *hi;

        b = g->vert[i];
        if ((a[1] > y) == (b[1] > y))
            continue;
        lo = a[1] < b[1] ? a : b;
        hi = lo == a ? b : a;
        if ((lo[0] - x) * (hi[1] - y) > (hi[0] - x) * (lo[1] - y))
            in = !in;
    }
    return in;
}

/* A line being set. */
struct setter {
    const struct rad_font *font;
    const unsigned char *text;
    int n;
    int32_t *gap; /* [n + 1], zeros to begin with */
};

static const struct rad_glyph *
glyph_at(const struct setter *s, int i)
{
    return i < s->n ? s->font->glyph[s->text[i]] : NULL;
}

static void
set_cells(struct setter *s)
{
    for (int i = 0; i < s->n; i++)
        s->gap[i + 1] = glyph_at(s, i) ? CELL : 0;
}

/* Put letters `space` apart, each with its own width; a space is as wide as the
 * mean letter.  A character without a glyph takes no room. */
static void
set_squeezed(struct setter *s, int space)
{
    int half = space / 2, i = 0;

    while (i < s->n && !glyph_at(s, i))
        i++;
    s->gap[i] = half;
    while (i < s->n) {
        const struct rad_glyph *g = glyph_at(s, i);

        if (!g) {
            s->gap[++i] = 0;
        } else if (g->nverts) {
            s->gap[i] += half - g->left;
            s->gap[++i] = g->right + half;
        } else {
            s->gap[++i] = s->font->mean_width;
        }
    }
    s->gap[s->n] += half;
}

/* The end of the column that begins at letter i.  A letter counts with the
 * spaces behind it; the column ends with the first that has more than
 * COLUMN_SPACES characters so.  *cells is the column's width in mean
 * letters. */
static int
column_end(const struct setter *s, int i, int *cells)
{
    *cells = 0;
    while (i < s->n) {
        int next = i + 1;

        if (glyph_at(s, i)) {
            const struct rad_glyph *g;

            while ((g = glyph_at(s, next)) && g->nverts == 0)
                next++;
            *cells += next - i;
        }
        if (next - i > COLUMN_SPACES)
            return next;
        i = next;
    }
    return i;
}

/* Squeeze, then stretch each column to a whole number of mean letters, so that
 * columns of several lines are aligned. */
static void
set_proportional(struct setter *s, int space)
{
    int i = 0, end, cells;

    set_squeezed(s, space);
    for (; i < s->n; i = end) {
        int spare;

        end = column_end(s, i, &cells);
        spare = cells * (s->font->mean_width + space);
        for (int k = i; k < end; k++)
            spare -= s->gap[k + 1];
        for (int k = i; k < end; k++) {
            int share = spare / (end - k);

            s->gap[k + 1] += share;
            spare -= share;
        }
    }
}

int
rad_textline_set(struct rad_textline *line, const struct rad_font *font,
                 struct rad_arena *arena, const char *text, size_t len,
                 int spacing, struct rad_error *err)
{
    struct setter s = { font, (const unsigned char *)text, (int)len, NULL };
    int32_t at = 0, reach = INT32_MIN;

    if (len > MAX_LINE || spacing > MAX_LINE / 10 || spacing < -MAX_LINE / 10)
        return rad_fail(err, RAD_EDATA, "line of text is too long");
    s.gap = rad_arena_calloc(arena, len + 1, sizeof *s.gap);
    line->start = s.gap; /* gaps are replaced by their running sum, below */
    line->reach = rad_arena_alloc(arena, (len + 1) * sizeof *line->reach);
    line->glyph = rad_arena_alloc(arena, (len + 1) * sizeof *line->glyph);
    if (!s.gap || !line->reach || !line->glyph)
        return rad_fail_memory(err);
    if (spacing == 0)
        set_cells(&s);
    else if (spacing > 0)
        set_proportional(&s, spacing);
    else
        set_squeezed(&s, -spacing);
    line->n = s.n;
    for (int i = 0; i < s.n; i++) {
        at += s.gap[i];
        reach = at > reach ? at : reach;
        line->start[i] = at;
        line->reach[i] = reach;
        line->glyph[i] = glyph_at(&s, i);
    }
    line->width = at + s.gap[s.n];
    return 0;
}

/* Try letters from the last one that begins at or before x back to where none
 * can reach x: a letter is at most 255 wide. */
bool
rad_textline_inside(const struct rad_textline *line, double x, double y)
{
    int32_t lo = 0, hi = line->n;

    if (!(x >= 0 && x < line->width))
        return false;
    while (lo < hi) { /* the first letter that starts beyond x */
        int32_t mid = lo + (hi - lo) / 2;

        if (line->reach[mid] > x)
            hi = mid;
        else
            lo = mid + 1;
    }
    while (lo-- > 0 && line->reach[lo] > x - CELL) {
        const struct rad_glyph *g = line->glyph[lo];

        if (g && x - line->start[lo] < CELL &&
            rad_glyph_inside(g, x - line->start[lo], y))
            return true;
    }
    return false;
}
