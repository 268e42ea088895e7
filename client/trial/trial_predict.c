/* trial_predict.c - from a trial to the whole job; see trial.h
 *
 * A pixel costs its rays and, until the cache is full, ambient records: the
 * first pixels of a picture take a hundred times as long as the last.  With t
 * the time (or the rays), n pixels and R records, t = a n + b R.  Here b is
 * fitted to the doublings of strewn pixels.  a is taken from windows, where the
 * sampler chooses the pixels and most records that they need exist.  Each
 * window is traced twice, the second time its upper half alone: that makes no
 * records, so it tells a by itself where a short trial has too few windows and
 * pixels to tell a and b apart.
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

/* Time or rays t of the strewn pixels are taken to be a n + b R, of n pixels
 * and R records, by least squares over the increments of each doubling,
 * relative to their size.  The first increment, which fills the cache, is left
 * out if there are others. */
struct sums {
    double nn, nr, rr, nt, rt;
};

static struct sums
sum_steps(const struct trial *t, bool time)
{
    struct sums m = { 0 };

    for (int i = t->nsteps > 3 ? 1 : 0; i < t->nsteps; i++) {
        struct trial_step zero = { 0, 0, 0, 0 };
        const struct trial_step *s = &t->step[i], *p = i ? s - 1 : &zero;
        double n = s->pixels - p->pixels, r = s->records - p->records;
        double y = time ? s->cpu_s - p->cpu_s : s->rays - p->rays;
        double w = y > 0 ? 1 / (y * y) : 0;

        m.nn += w * n * n;
        m.nr += w * n * r;
        m.rr += w * r * r;
        m.nt += w * n * y;
        m.rt += w * r * y;
    }
    return m;
}

struct fit {
    double a, b;
};

static struct fit
fit_steps(const struct trial *t, bool time)
{
    struct sums m = sum_steps(t, time);
    double det = m.nn * m.rr - m.nr * m.nr;
    struct fit f = { 0, 0 };

    if (det > 1e-9 * m.nn * m.rr) {
        f.a = (m.nt * m.rr - m.rt * m.nr) / det;
        f.b = (m.rt * m.nn - m.nt * m.nr) / det;
    }
    if (!(f.a > 0 && f.b > 0)) {
        /* charge all to records, or to pixels if there are no records */
        f.a = m.rr > 0 ? 0 : m.nn > 0 ? m.nt / m.nn : 0;
        f.b = m.rr > 0 ? m.rt / m.rr : 0;
    }
    return f;
}

/* Time or rays of a pixel whose records exist. */
static double
cost_of_pixel(const struct trial *t, bool time)
{
    double sum = time ? t->again_cpu_s : t->again_rays;

    return t->again_primary > 0 ? sum / t->again_primary : 0;
}

/* Time or rays of a record if a pixel takes a: b for that a. */
static double
cost_of_record(const struct trial *t, bool time, double a)
{
    struct sums m = sum_steps(t, time);
    double rt = m.rt - a * m.nr;

    return m.rr > 0 && rt > 0 ? rt / m.rr : 0;
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

static double
field(const struct trial_step *s, bool time)
{
    return time ? s->cpu_s : s->rays;
}

/* Time or rays of a strewn pixel, of a primary ray of the picture and of a
 * record. */
struct price {
    double strewn, primary, record;
};

/* Prices from many windows: their first tracing less its records.  So records
 * that come faster than the strewn pixels tell are included. */
static struct price
price_by_windows(const struct trial *t, bool time)
{
    struct fit f = fit_steps(t, time);
    double windows = (time ? t->cpu_s : t->rays) - f.b * t->records;
    double a = t->primary > 0 ? windows / t->primary : 0;

    if (!(a > .2 * f.a))
        a = .2 * f.a; /* windows that made little but records */
    return (struct price){ f.a, a, f.b };
}

/* Prices from few windows: their second tracing, for most records of the first
 * one would be shared with neighbouring windows. */
static struct price
price_by_second_time(const struct trial *t, bool time)
{
    double a = cost_of_pixel(t, time);

    return (struct price){ a, a, cost_of_record(t, time, a) };
}

/* Time or rays of the picture: the records that were made and those to come,
 * and pixels as in the windows. */
static double
total(const struct trial *t, bool time, double primary, double more_records)
{
    const double MANY = 5000; /* primary rays in windows, at least */
    const struct trial_step *last = &t->step[t->nsteps - 1];
    struct price p = t->primary < MANY ? price_by_second_time(t, time)
                                       : price_by_windows(t, time);
    double strewn = field(last, time) - p.strewn * last->pixels;
    double records = (strewn > 0 ? strewn : 0) + p.record * more_records;

    return RARE * records + p.primary * primary;
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
