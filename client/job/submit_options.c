/* submit_options.c - see submit_options.h */
#include "config.h"

#include "job/submit_options.h"
#include "common/outname.h"
#include "common/tell.h"
#include "job/quality.h"
#include "show/picfile.h"

#include <string.h>

void
submit_options_init(struct submit_options *o)
{
    memset(o, 0, sizeof *o);
    rad_params_init(&o->params);
    rad_view_init(&o->view);
    o->wait_s = 60;
    o->quality = o->tone = o->bits = o->spectral = -1;
    show_init(&o->show);
    o->partition = PARTITION_NONE;
    o->order = ORDER_NONE;
    o->ambient_way = AMBIENT_NONE;
    pointspec_init(&o->points);
}

int
submit_options_planes(const struct submit_options *o)
{
    const struct rad_bands *b = &o->params.bands;

    return rad_bands_many(b) ? rad_bands_planes(b) : 0;
}

bool
submit_options_hsr(const struct submit_options *o)
{
    return o->format == PICFILE_BY_SUFFIX && o->output &&
           outname_suffix(o->output, ".hsr");
}

bool
submit_options_spectra(const struct submit_options *o)
{
    return submit_options_planes(o) > 0 &&
           (o->spectral < 0 ? submit_options_hsr(o) : o->spectral > 0);
}

bool
submit_options_cache(const struct submit_options *o)
{
    const struct rad_params *p = &o->params;

    return p->ambounce > 0 && p->ambacc > 0 && p->ambdiv > 0;
}

bool
submit_options_goal(const struct submit_options *o)
{
    return o->error > 0 || o->time_s > 0;
}

void
submit_options_samples(struct submit_options *o)
{
    if (o->oversample > 0)
        return;
    if (o->quality >= 0)
        o->oversample = quality_oversample(o->quality);
    else
        o->oversample =
            picfile_is_png(o->output, (enum picfile_format)o->format) ? 2 : 1;
}

/* tell_line() for what sensor points have: nothing of a picture's pixels. */
static void
print_for_points(void *to, const char *text)
{
    static const char *const of_pixels[] = { "-x ",  "-y ",  "-pa ", "-pj ",
                                             "-ps ", "-pt ", "-pm ", "-pd " };

    for (size_t i = 0; i < sizeof of_pixels / sizeof of_pixels[0]; i++)
        if (strncmp(text, of_pixels[i], strlen(of_pixels[i])) == 0)
            return;
    tell_line(to, text);
}

static void
print_points_defaults(const struct submit_options *o, FILE *to)
{
    const struct pointspec *s = &o->points;

    fprintf(to, "-x %-28d # points a row\n", s->x);
    fprintf(to, "-y %-28d # rows\n", s->y);
    fprintf(to, "%-31s # limit distance\n", s->limited ? "-ld+" : "-ld-");
    fprintf(to, "%-31s # output header\n", s->no_header ? "-h-" : "-h+");
    fprintf(to, "-f%c%-28c # format of points and values\n", s->in, s->out);
    fprintf(to, "-o%-29s # values\n", s->values);
    fprintf(to, "%-31s # irradiance at the points\n",
            s->irradiance ? "-I+" : "-I-");
    rad_params_print_defaults(&o->params, print_for_points, to);
    if (s->mean)
        fprintf(to, "%-31s # light as one number\n", s->mean);
}

static void
print_picture_defaults(const struct submit_options *o, FILE *to)
{
    struct submit_options chosen = *o;

    rad_view_print_defaults(&o->view, tell_line, to);
    rad_params_print_defaults(&o->params, tell_line, to);
    submit_options_samples(&chosen);
    fprintf(to, "--oversample %-18d # samples a side of a pixel\n",
            chosen.oversample);
}

void
submit_options_defaults(const struct submit_options *o, FILE *to)
{
    (o->points.file ? print_points_defaults : print_picture_defaults)(o, to);
    fprintf(to, "-t %-28d # time between reports\n", o->report_s);
    fprintf(to, "%-31s # warning messages\n", o->quiet ? "-w-" : "-w+");
}
