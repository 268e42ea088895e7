/* colours.c - see colours.h */
#include "config.h"

#include "filling/colours.h"

_Static_assert(4 * RAD_PASS_MOST_COLOURS <= MSG_MAX_COLOURS, "too many");

/* Where the pixels of a tile's lattice lie: a struct without its colours. */
static struct action_colours
lattice(const struct job *job, const struct rad_pass *pass, uint32_t tile)
{
    const struct msg_frame *frames = job->spec.frames;
    uint32_t frame = pass->frame, n;
    struct rad_pass_area a;

    while (tile >= (n = rad_pass_tiles(pass, (int)frames[frame].width,
                                       (int)frames[frame].height))) {
        tile -= n;
        frame += pass->stride;
    }
    a = rad_pass_area(pass, (int)frames[frame].width, (int)frames[frame].height,
                      tile);
    return (struct action_colours){
        .frame = frame,
        .x = a.x0,
        .y = a.y0,
        .step = pass->step,
        .columns = (a.x1 - a.x0 - 1) / pass->step + 1,
        .rows = (a.y1 - a.y0 - 1) / pass->step + 1,
    };
}

bool
colours_wanted(const struct job *job, const struct rad_pass *pass)
{
    return job->watched && rad_pass_shows(pass);
}

bool
colours_fit(const struct job *job, const struct rad_pass *pass, uint32_t tile,
            size_t len)
{
    struct action_colours k;

    if (len == 0 || !rad_pass_shows(pass))
        return len == 0;
    k = lattice(job, pass, tile);
    return len == 4 * (size_t)k.columns * (size_t)k.rows;
}

void
colours_keep(struct coord *c, struct job *job, const struct rad_pass *pass,
             const struct msg_tile_made *m)
{
    struct action *a;

    if (m->colours_len == 0 || !job->watched)
        return;
    a = actions_add_job(&c->actions, ACT_PUT_COLOURS, 0, job->id);
    if (!a)
        return;
    a->colours = lattice(job, pass, m->tile);
    a->colours.rgbe = actions_keep(&c->actions, m->colours, m->colours_len);
}

void
colours_close(struct job *job, const struct rad_pass *pass)
{
    if (colours_wanted(job, pass))
        for (uint32_t i = pass->frame; i < pass->beyond; i += pass->stride)
            job->frames[i].has_colours = true;
}
