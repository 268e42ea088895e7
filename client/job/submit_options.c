/* submit_options.c - see submit_options.h */
#include "config.h"

#include "job/submit_options.h"
#include "common/outname.h"
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
    o->order = ORDER_NONE;
    o->ambient_way = AMBIENT_NONE;
    pointspec_init(&o->points);
}

int
submit_options_planes(const struct submit_options *o)
{
    return o->params.bands.plane >= 0 ? 1 : rad_bands_planes(&o->params.bands);
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
    return submit_options_planes(o) > 1 &&
           (o->spectral < 0 ? submit_options_hsr(o) : o->spectral > 0);
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

static void
print_line(void *to, const char *text)
{
    fprintf(to, "%s\n", text);
}

void
submit_options_defaults(const struct submit_options *o, FILE *to)
{
    struct submit_options chosen = *o;
    char text[32];

    rad_view_print_defaults(&o->view, print_line, to);
    rad_params_print_defaults(&o->params, print_line, to);
    submit_options_samples(&chosen);
    snprintf(text, sizeof text, "--oversample %d", chosen.oversample);
    fprintf(to, "%-31s # samples a side of a pixel\n", text);
    snprintf(text, sizeof text, "-t %d", o->report_s);
    fprintf(to, "%-31s # time between reports\n", text);
    fprintf(to, "%-31s # warning messages\n", o->quiet ? "-w-" : "-w+");
}
