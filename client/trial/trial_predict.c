/* trial_predict.c - from a trial to the whole job; see trial.h
 *
 * A pixel costs its rays and, until the cache is full, ambient records: the
 * first pixels of a picture take a hundred times as long as the last.  With t
 * the time (or the rays), n pixels and R records, t = a n + b R.  a is taken
 * from windows, where the sampler chooses the pixels, as they are traced a
 * second time, their upper half alone: that makes no records.  b is what is
 * left of the first time.
 * The number of records grows evenly with the logarithm of the pixels once
 * every surface has some, for each doubling asks for records between those.
 * This was measured on an office, a drafting room and a box, from 256 pixels to
 * 260 000.  A fine cache of one bounce has not reached that after a trial;
 * there the number is taken from the windows. */
#include "config.h"

#include "trial/trial.h"

#include <math.h>

/* memory of a record, with its places in the cache [bytes] */
#define RECORD_BYTES 320.

/* The job's records, by those of the trial: a short trial does not meet what is
 * rare in a picture, tiles or workers make some records twice, and bounces that
 * were not tried make a few more. */
static const double RARE = 1.2;

/* Time or rays of a pixel whose records exist. */
static double
cost_of_pixel(const struct trial *t, bool time)
{
    double sum = time ? t->again_cpu_s : t->again_rays;

    return t->again_primary > 0 ? sum / t->again_primary : 0;
}

/* How many records each further doubling of the pixels makes. */
static double
records_a_doubling(const struct trial *t)
{
    int last = t->nsteps - 1, first = last > 3 ? last - 3 : 0;
    double octaves;

    if (last <= first)
        return 0;
    octaves = log2(t->step[last].pixels / t->step[first].pixels);
    return (t->step[last].records - t->step[first].records) / octaves;
}

/* Does each doubling still make nearly twice as many records as the one before?
 * Then their number does not grow by the logarithm yet. */
static bool
unsaturated(const struct trial *t)
{
    const struct trial_step *s = &t->step[t->nsteps - 1];

    if (t->nsteps > 1 && s->pixels < 2 * s[-1].pixels)
        s--; /* the last step is no whole doubling */
    return s - t->step >= 2 &&
           s->records - s[-1].records > 1.7 * (s[-1].records - s[-2].records);
}

/* How many records are still to be made for that many pixels and primary rays:
 * the same number for each doubling of primary rays; while the cache is
 * unsaturated, as many per pixel as in the windows. */
static double
records_to_come(const struct trial *t, double pixels, double primary)
{
    const struct trial_step *last = &t->step[t->nsteps - 1];
    double more = 0;

    if (primary > last->pixels)
        more = records_a_doubling(t) * log2(primary / last->pixels);
    if (unsaturated(t) && t->pixels > 0)
        more = fmax(more, pixels * t->records / t->pixels - last->records);
    return more;
}

/* What pixels took but for a each: for their records. */
static double
rest(double all, double pixels, double a)
{
    return fmax(all - a * pixels, 0);
}

/* Time or rays of the picture: of its pixels, of the records that the strewn
 * pixels made, and of those to come, as in the windows. */
static double
total(const struct trial *t, bool time, double primary, double more_records)
{
    const struct trial_step *last = &t->step[t->nsteps - 1];
    double a = cost_of_pixel(t, time);
    double made = rest(time ? last->cpu_s : last->rays, last->pixels, a);
    double in_windows = rest(time ? t->cpu_s : t->rays, t->primary, a);
    double b = t->records > 0      ? in_windows / t->records
               : last->records > 0 ? made / last->records
                                   : 0;

    return a * primary + RARE * (made + b * more_records);
}

void
trial_predict(const struct trial *t, double pixels, struct prediction *p)
{
    const struct trial_step *last = &t->step[t->nsteps - 1];
    double more, records;

    p->primary_rays = t->usual_pixels > 0
                          ? pixels * t->usual_primary / t->usual_pixels
                          : pixels;
    more = records_to_come(t, pixels, p->primary_rays);
    records = RARE * (last->records + more);
    p->ambient_values = records;
    p->rays = total(t, false, p->primary_rays, more);
    p->load_s = t->load_s;
    p->cpu_s = t->load_s + total(t, true, p->primary_rays, more);
    p->error = rad_doubt_error(&t->doubt);
    p->bytes = t->peak_bytes + RECORD_BYTES * (records - last->records);
}

void
trial_repeat(struct prediction *p, int times)
{
    p->primary_rays *= times;
    p->rays *= times;
    p->ambient_values *= times;
    p->cpu_s *= times;
    p->load_s *= times;
}
