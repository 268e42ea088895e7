/* legend.c - see legend.h
 *
 *   margin  title
 *           bar - text of a tick
 *               -
 *           bar - text of a tick   margin
 *
 * Sizes are in dots of the font, which grow with the picture's height. */
#include "config.h"

#include "tone/legend.h"

enum {
    DOT_PER = 270, /* a dot is one pixel for each so many rows of the picture */
    MARGIN = 5,    /* this and the next two in dots */
    BAR = 12,
    TICK = 3,
    LEAST_ROWS = 90 /* of the image, in pixels */
};

static int
dot_size(int height)
{
    int dot = (height + DOT_PER / 2) / DOT_PER;

    return dot > 1 ? dot : 1;
}

static int
widest_tick(const struct rad_legend *l, int dot)
{
    int most = 0;

    for (int i = 0; i < l->nticks; i++) {
        int w = rad_image_text_width(l->tick[i].text, dot);

        most = w > most ? w : most;
    }
    return most;
}

/* The rows that the bar takes. */
struct extent {
    int top, height;
};

static struct extent
bar_extent(const struct rad_image *m, int dot)
{
    int top = (MARGIN + RAD_FONT_LINE + MARGIN) * dot;

    return (struct extent){ top, m->height - top - 2 * MARGIN * dot };
}

/* The lowest tick of each step-th, counted from the scale's end. */
static int
first_tick(const struct rad_legend *l, int step)
{
    return (l->nticks - 1) % step;
}

/* The least n so that each n-th tick has room for its text. */
static int
tick_step(const struct rad_legend *l, const struct extent *bar, int dot)
{
    int step = 1;
    double room = 0;

    for (; step < l->nticks; step++) {
        room = 1;
        for (int i = first_tick(l, step) + step; i < l->nticks; i += step)
            if (l->tick[i].at - l->tick[i - step].at < room)
                room = l->tick[i].at - l->tick[i - step].at;
        if (room * bar->height >= RAD_FONT_LINE * dot)
            break;
    }
    return step;
}

static void
draw(const struct rad_legend *l, struct rad_image *m, int x, int dot)
{
    static const uint8_t white[3] = { 255, 255, 255 };
    struct extent bar = bar_extent(m, dot);
    int step = tick_step(l, &bar, dot);
    uint8_t rgb[3];

    rad_image_text(m, x, MARGIN * dot, dot, l->title, white);
    for (int y = 0; y < bar.height; y++) {
        l->colour(l->arg, 1 - (y + .5) / bar.height, rgb);
        rad_image_fill(m, x, bar.top + y, BAR * dot, 1, rgb);
    }
    for (int i = first_tick(l, step); i < l->nticks; i += step) {
        int y = bar.top + (int)((1 - l->tick[i].at) * (bar.height - 1) + .5);

        rad_image_fill(m, x + BAR * dot, y - dot / 2, TICK * dot, dot, white);
        rad_image_text(m, x + (BAR + TICK + 2) * dot,
                       y - RAD_FONT_HEIGHT * dot / 2, dot, l->tick[i].text,
                       white);
    }
}

int
rad_legend_image(const struct rad_legend *l, int width, int height,
                 struct rad_image *out, struct rad_error *err)
{
    int dot = dot_size(height);
    int beside = (BAR + TICK + 2) * dot + widest_tick(l, dot);
    int title = rad_image_text_width(l->title, dot);
    int wide = (beside > title ? beside : title) + 2 * MARGIN * dot;
    int rc = rad_image_new(out, width + wide,
                           height > LEAST_ROWS ? height : LEAST_ROWS, err);

    if (rc == 0)
        draw(l, out, width + MARGIN * dot, dot);
    return rc;
}
