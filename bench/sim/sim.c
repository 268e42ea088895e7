/* sim.c - how each way to share a picture scales, from one host to a thousand
 *
 * usage: sim [options] [STATISTICS.json]
 * With --tiles=FILE, of bench/passes, the ambient cache is filled in passes
 * before the picture, and their costs are those of the file.
 *
 * The real scheduler drives simulated hosts (cluster.h), whose work costs what
 * a former run's statistics say (radsubmit --stats; best of a scanbar run), or
 * made-up costs.  Prints speed-up and efficiency for each way and number of
 * hosts, and where each stops to scale; draws them with gnuplot. */
#include "config.h"

#include "cluster.h"

#include "base/list.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

enum { MOST_HOSTS = 4096, MOST_COUNTS = 32, MOST_WAYS = 16 };

/* A way to share. */
struct way {
    const char *name;
    enum msg_partition partition;
    enum msg_order order;
    const char *estimate;
    uint32_t flags;
};

static const struct way all_ways[] = {
    { "auto", MSG_PART_AUTO, 0, "uniform", 0 },
    { "scanbar", MSG_PART_SCANBAR, 0, "uniform", 0 },
    { "static", MSG_PART_STATIC, 0, "uniform", 0 },
    { "window", MSG_PART_WINDOW, 0, "uniform", 0 },
    { "static-20a", MSG_PART_STATIC, 0, "20a", 0 },
    { "static-optimum", MSG_PART_STATIC, 0, "optimum", 0 },
    { "fixed-uniform", MSG_PART_STATIC, 0, "uniform", MSG_JOB_NO_BALANCE },
    { "fixed-5a", MSG_PART_STATIC, 0, "5a", MSG_JOB_NO_BALANCE },
    { "fixed-20a", MSG_PART_STATIC, 0, "20a", MSG_JOB_NO_BALANCE },
    { "fixed-optimum", MSG_PART_STATIC, 0, "optimum", MSG_JOB_NO_BALANCE },
    { "window-cost", MSG_PART_WINDOW, MSG_ORDER_COST, "20a", 0 },
};

struct options {
    struct map_spec map;
    struct cluster_spec cluster;
    const char *hosts, *ways, *plot, *tiles;
    bool details, timeline, share, live;
};

struct number {
    const char *name;
    double *to, scale, lo, hi;
    const char *help;
};

/* Table of one run. */
struct bench {
    struct map map;
    struct tiles tiles; /* npasses 0: there are none */
    int hosts[MOST_COUNTS], nhosts;
    const struct way *ways[MOST_WAYS];
    int nways;
    struct cluster_result result[MOST_WAYS][MOST_COUNTS];
    double alone_s; /* one thread of speed 1 */
};

/* What options with numbers set, and the doubles of those that are ints. */
struct numbers {
    double threads, frames, windows, seed;
};

_Noreturn static void
die(int status, const char *what, const char *subject)
{
    fprintf(stderr, "sim: %s%s%s\n", what, subject ? ": " : "",
            subject ? subject : "");
    exit(status);
}

static int
number_table(struct options *o, struct numbers *n, struct number *t)
{
    struct cluster_spec *c = &o->cluster;
    const struct number table[] = {
        { "--seconds", &o->map.seconds, 1, 0, 1e9,
          "of one host for a frame (by the statistics and the size)" },
        { "--frames", &n->frames, 1, 1, 10000, "of an animation (1)" },
        { "--base", &o->map.base, 1, .01, 100,
          "cost of a base line's row over a bar's row (1.5)" },
        { "--threads", &n->threads, 1, 1, 256, "of each host (1)" },
        { "--uneven", &c->uneven, 1, 1, 1000,
          "fastest host's speed over the slowest's (1)" },
        { "--slow", &c->slow, 1, 1, 1000,
          "the last host slower by so much (1)" },
        { "--latency", &c->latency_us, 1000, 0, 1e6, "one way, ms (.1)" },
        { "--bandwidth", &c->bandwidth, 125000, 1e-3, 1e6,
          "of each link, Mbit/s (1000)" },
        { "--coord", &c->coord_us, 1, 0, 1e6,
          "that the coordinator takes for a message, us (20)" },
        { "--disk", &c->disk_us, 1000, 0, 1e6, "until rows are kept, ms (25)" },
        { "--load", &c->load_us, 1e6, 0, 1e6,
          "of the scene, on a host of speed 1, s (.05)" },
        { "--insert", &c->insert_us, 1, 0, 1e6,
          "of a record of a closed pass into a cache, us (.5)" },
        { "--growth", &c->growth, .01, 0, 1000,
          "more work with each doubling of hosts, % (0)" },
        { "--failures", &c->failures, 1, 0, 1e6, "of a host in an hour (0)" },
        { "--back", &c->back_us, 1e6, 0, 1e6,
          "until a host that failed is there again, s (30)" },
        { "--windows", &n->windows, 1, 0, 1e6, "how many (by the size)" },
        { "--seed", &n->seed, 1, 0, 1e15, "(0)" },
    };

    memcpy(t, table, sizeof table);
    return N_ELEM(table);
}

static void
usage(const struct number *t, int n)
{
    puts("usage: sim [options] [STATISTICS.json]\n"
         "  --size=WxH        of the picture (that of the statistics, or "
         "480x320)\n"
         "  --picture=FILE    what the sampler meets, an HDR picture: so some "
         "guesses at\n"
         "                    lines above are wrong (noise everywhere)\n"
         "  --tiles=FILE      costs of a job with passes, from bench/passes: "
         "its size,\n"
         "                    its options\n"
         "  --ambient=live    with --tiles: the same job without passes\n"
         "  --hosts=LIST      (1,2,4,8,16,32,64,128,256,512,1000)\n"
         "  --ways=LIST       of those below (auto,scanbar,static,window)\n"
         "  --plot=FILE       draw it: FILE.png or FILE.svg\n"
         "  --details         more about each run\n"
         "  --timeline        what threads do, by time: of each slice of a "
         "run, in %\n"
         "                    load, trace (under a true top, ahead), wait for "
         "a base\n"
         "                    line, or the line above in a team, have no "
         "unit\n"
         "  --share           peers' links, as for ambient values\n"
         "  --verbose         every message");
    for (int i = 0; i < n; i++)
        printf("  %-10s=N     %s\n", t[i].name, t[i].help);
    printf("ways:");
    for (int i = 0; i < N_ELEM(all_ways); i++)
        printf(" %s", all_ways[i].name);
    puts("");
}

/* The value of "--name=value", if it is that option; or NULL. */
static const char *
value_of(const char *arg, const char *name)
{
    size_t n = strlen(name);

    return strncmp(arg, name, n) == 0 && arg[n] == '=' ? arg + n + 1 : NULL;
}

static bool
take_number(const char *arg, const struct number *t, int n)
{
    for (int i = 0; i < n; i++) {
        const char *value = value_of(arg, t[i].name);
        char *end;
        double v;

        if (!value)
            continue;
        v = strtod(value, &end);
        if (end == value || *end || !(v >= t[i].lo && v <= t[i].hi))
            die(EX_USAGE, "not a number that is allowed", arg);
        *t[i].to = v * t[i].scale;
        return true;
    }
    return false;
}

static void
take_size(struct options *o, const char *value)
{
    char x;

    if (sscanf(value, "%d%c%d", &o->map.width, &x, &o->map.height) != 3 ||
        x != 'x' || o->map.width < 32 || o->map.height < 1 ||
        o->map.width > MSG_MAX_SIDE || o->map.height > MSG_MAX_SIDE)
        die(EX_USAGE, "no size, such as 3840x2160", value);
}

static void
take_option(struct options *o, const struct number *t, int n, const char *arg)
{
    const char *v;

    if (take_number(arg, t, n))
        return;
    if ((v = value_of(arg, "--size")))
        take_size(o, v);
    else if ((v = value_of(arg, "--hosts")))
        o->hosts = v;
    else if ((v = value_of(arg, "--ways")))
        o->ways = v;
    else if ((v = value_of(arg, "--plot")))
        o->plot = v;
    else if ((v = value_of(arg, "--picture")))
        o->map.picture = v;
    else if ((v = value_of(arg, "--tiles")))
        o->tiles = v;
    else if ((v = value_of(arg, "--ambient")) &&
             (strcmp(v, "live") == 0 || strcmp(v, "passes") == 0))
        o->live = strcmp(v, "live") == 0;
    else if (strcmp(arg, "--details") == 0)
        o->details = true;
    else if (strcmp(arg, "--timeline") == 0)
        o->timeline = true;
    else if (strcmp(arg, "--share") == 0)
        o->share = true;
    else if (strcmp(arg, "--verbose") == 0)
        o->cluster.verbose = true;
    else if (arg[0] == '-')
        die(EX_USAGE, "unknown option", arg);
    else if (o->map.file)
        die(EX_USAGE, "one statistics file is enough", arg);
    else
        o->map.file = arg;
}

static void
parse(struct options *o, int argc, char *argv[])
{
    struct numbers n = { .threads = 1 };
    struct number t[32];
    int nt;

    *o = (struct options){
        .map = { .base = 1.5 },
        .cluster = { .uneven = 1,
                     .slow = 1,
                     .latency_us = 100,
                     .bandwidth = 125e6,
                     .coord_us = 20,
                     .disk_us = 25000,
                     .load_us = 50000,
                     .insert_us = .5,
                     .back_us = 30e6 },
        .hosts = "1,2,4,8,16,32,64,128,256,512,1000",
        .ways = "auto,scanbar,static,window",
    };
    nt = number_table(o, &n, t);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0) {
            usage(t, nt);
            exit(EX_OK);
        }
        take_option(o, t, nt, argv[i]);
    }
    o->map.nframes = (uint32_t)n.frames;
    o->cluster.threads = (int)n.threads;
    o->cluster.windows = (uint32_t)n.windows;
    o->cluster.seed = (uint64_t)n.seed;
}

/* The next word of a list with commas; false at its end. */
static bool
next_word(const char **list, char *word, size_t room)
{
    size_t n = strcspn(*list, ",");

    if (**list == '\0')
        return false;
    snprintf(word, room, "%.*s", (int)n, *list);
    *list += n + ((*list)[n] == ',');
    return true;
}

static void
choose(struct bench *b, const struct options *o)
{
    const char *list = o->hosts;
    char word[64], *end;

    while (next_word(&list, word, sizeof word)) {
        long n = strtol(word, &end, 10);

        if (end == word || *end || n < 1 || n > MOST_HOSTS ||
            b->nhosts == MOST_COUNTS)
            die(EX_USAGE, "not a list of numbers of hosts", o->hosts);
        b->hosts[b->nhosts++] = (int)n;
    }
    list = o->ways;
    while (next_word(&list, word, sizeof word)) {
        const struct way *w = NULL;

        for (int i = 0; i < N_ELEM(all_ways); i++)
            if (strcmp(all_ways[i].name, word) == 0)
                w = &all_ways[i];
        if (!w || b->nways == MOST_WAYS)
            die(EX_USAGE, "no way to share", word);
        b->ways[b->nways++] = w;
    }
}

static void
simulate(struct bench *b, const struct options *o, const struct way *w,
         int hosts, struct cluster_result *out)
{
    struct cluster_spec s = o->cluster;

    s.map = &b->map;
    s.tiles = b->tiles.npasses > 0 && !o->live ? &b->tiles : NULL;
    s.hosts = hosts;
    s.partition = w->partition;
    s.order = w->order;
    s.estimate = w->estimate;
    s.flags = w->flags | (o->share ? MSG_JOB_SHARE : 0);
    cluster_run(&s, out);
}

/* One host of one thread and speed 1 that never fails. */
static void
simulate_alone(struct bench *b, const struct options *o)
{
    struct options one = *o;
    struct cluster_result r;

    one.cluster.uneven = one.cluster.slow = one.cluster.threads = 1;
    one.cluster.failures = 0;
    simulate(b, &one, &all_ways[0], 1, &r);
    if (!r.done)
        die(EX_SOFTWARE, "one host alone", r.text);
    b->alone_s = r.seconds;
}

/* --- what is said --- */

static double
speed_up(const struct bench *b, const struct cluster_result *r)
{
    return r->done ? b->alone_s / r->seconds : 0;
}

static double
efficiency(const struct bench *b, const struct cluster_result *r)
{
    return speed_up(b, r) / r->speed;
}

/* Pixels traced more than once, as a part of all. */
static double
twice(const struct bench *b, const struct cluster_result *r)
{
    double wanted = (double)b->map.nwanted * b->map.nframes;

    return r->traced > 0 ? (double)r->traced / wanted - 1 : 0;
}

static void
say_details(const struct bench *b, const struct way *w, int hosts,
            const struct cluster_result *r)
{
    if (!r->done) {
        printf("%-15s %5d  %s\n", w->name, hosts, r->text);
        return;
    }
    printf("%-15s %5d %9.3f s  eff %5.1f %%  busy %5.1f %%  wait %4.1f %%  "
           "twice %5.2f %%  units %6llu  messages %8llu  %8.2f MB  base lines "
           "%7.2f MB  radcoord %.3f s  failed %llu\n",
           w->name, hosts, r->seconds, 100 * efficiency(b, r),
           100 * r->busy_s / (r->seconds * r->threads),
           100 * r->wait_s / r->seconds, 100 * twice(b, r),
           (unsigned long long)r->units, (unsigned long long)r->messages,
           1e-6 * (double)r->bytes, 1e-6 * (double)r->base_line_bytes,
           r->coord_s, (unsigned long long)r->failed);
}

/* In percent of all threads' time. */
static double
share_of(const struct cluster_result *r, enum host_state state)
{
    double sum = 0;

    for (int k = 0; k < CLUSTER_SLICES; k++)
        sum += r->state_s[k][state];
    return 100 * sum / (r->seconds * r->threads);
}

/* What the passes lose, and to what. */
static void
say_passes(const struct cluster_result *r)
{
    double twice = 100 * r->twice_s / (r->seconds * r->threads);

    printf("%21s passes %.3f s: tiles %.1f %%, made twice %.1f, paths %.1f, "
           "ends of passes %.1f, records on their way %.1f, into caches %.1f, "
           "waiting for that %.1f; loading %.1f, no unit %.1f, base lines "
           "%.1f, the line above %.1f;  TILE_MADE %.2f MB, "
           "records on by radcoord %.2f MB, by hosts %.2f MB, FROZEN %.2f "
           "MB\n",
           "", r->passes_s, share_of(r, HOST_TILES) - twice, twice,
           share_of(r, HOST_WALKS), share_of(r, HOST_BARRIER),
           share_of(r, HOST_RECORDS), share_of(r, HOST_INSERTS),
           share_of(r, HOST_CHANGES), share_of(r, HOST_LOADS),
           share_of(r, HOST_EMPTY), share_of(r, HOST_WAITS),
           share_of(r, HOST_BELOW), 1e-6 * (double)r->tile_bytes,
           1e-6 * (double)r->records_bytes, 1e-6 * (double)r->peer_bytes,
           1e-6 * (double)r->frozen_bytes);
}

/* What threads do in each slice of a run, in percent. */
static void
say_timeline(const struct cluster_result *r)
{
    static const char *const name[HOST_STATES] = {
        "load",  "truth", "ahead",  "wait",   "below",   "empty",
        "tiles", "paths", "insert", "change", "barrier", "records"
    };
    double slice_s = r->work / r->speed / CLUSTER_SLICES_IDEAL;
    double sum[HOST_STATES] = { 0 };

    printf("%8s", "until s");
    for (int s = 0; s < HOST_STATES; s++)
        printf("%8s", name[s]);
    puts("");
    for (int k = 0; k < CLUSTER_SLICES && k * slice_s < r->seconds; k++) {
        printf("%8.3f", fmin((k + 1) * slice_s, r->seconds));
        for (int s = 0; s < HOST_STATES; s++) {
            printf("%8.1f", 100 * r->state_s[k][s] / (slice_s * r->threads));
            sum[s] += r->state_s[k][s];
        }
        puts("");
    }
    printf("%8s", "in all");
    for (int s = 0; s < HOST_STATES; s++)
        printf("%8.1f", 100 * sum[s] / (r->seconds * r->threads));
    puts("");
}

static void
say_table(const struct bench *b)
{
    printf("\nSpeed-up, and efficiency in %%\n%6s", "hosts");
    for (int k = 0; k < b->nways; k++)
        printf("%21s", b->ways[k]->name);
    puts("");
    for (int i = 0; i < b->nhosts; i++) {
        printf("%6d", b->hosts[i]);
        for (int k = 0; k < b->nways; k++) {
            const struct cluster_result *r = &b->result[k][i];

            if (r->done)
                printf("%12.2f %8.1f", speed_up(b, r), 100 * efficiency(b, r));
            else
                printf("%21s", "-");
        }
        puts("");
    }
}

/* Where a way stops: the most hosts that are at least half of use, and those
 * beyond which there is no gain. */
static void
say_limit(const struct bench *b, int way)
{
    int half = 0, best = -1;

    for (int i = 0; i < b->nhosts; i++) {
        const struct cluster_result *r = &b->result[way][i];

        if (!r->done)
            continue;
        if (efficiency(b, r) >= .5 && b->hosts[i] > half)
            half = b->hosts[i];
        if (best < 0 || speed_up(b, r) > speed_up(b, &b->result[way][best]))
            best = i;
    }
    if (best < 0) {
        printf("%-15s %s\n", b->ways[way]->name, b->result[way][0].text);
        return;
    }
    printf("%-15s at least 50 %% efficient up to %d hosts; fastest with %d: "
           "%.2f\n",
           b->ways[way]->name, half, b->hosts[best],
           speed_up(b, &b->result[way][best]));
}

static void
plot_data(FILE *f, const struct bench *b)
{
    for (int k = 0; k < b->nways; k++) {
        for (int i = 0; i < b->nhosts; i++)
            if (b->result[k][i].done)
                fprintf(f, "%d %g\n", b->hosts[i],
                        speed_up(b, &b->result[k][i]));
        fputs("e\n", f);
    }
}

static void
plot(const struct bench *b, const char *file)
{
    const char *dot = strrchr(file, '.');
    bool svg = dot && strcmp(dot, ".svg") == 0;
    FILE *f;

    if (strchr(file, '\''))
        die(EX_USAGE, "no name for a plot", file);
    f = popen("gnuplot", "w");
    if (!f)
        die(EX_OSERR, "cannot run gnuplot", strerror(errno));
    fprintf(f, "set terminal %s size 800,600\nset output '%s'\n",
            svg ? "svg" : "pngcairo", file);
    fputs("set logscale xy 2\nset grid\nset key left top\n"
          "set xlabel 'hosts'\nset ylabel 'speed-up'\n"
          "plot x with lines dashtype 2 linecolor 'grey' title 'ideal'",
          f);
    for (int k = 0; k < b->nways; k++)
        fprintf(f, ", '-' with linespoints title '%s'", b->ways[k]->name);
    fputs("\n", f);
    plot_data(f, b);
    if (pclose(f) != 0)
        die(EX_UNAVAILABLE, "gnuplot is not there, or failed", NULL);
    printf("\nPlot: %s\n", file);
}

/* The job is that of the file of tiles. */
static int
take_tiles(struct bench *b, struct options *o, struct rad_error *err)
{
    struct tiles *t = &b->tiles;
    int rc = tiles_read(t, o->tiles, err);

    if (rc < 0)
        return rc;
    if (o->map.width || o->map.nframes > 1)
        die(EX_USAGE, "size and frames are those of the tiles", NULL);
    if (o->map.seconds > 0)
        tiles_scale(t, o->map.seconds);
    o->map.width = t->width;
    o->map.height = t->height;
    o->map.seconds = o->live ? t->live_s : t->picture_s;
    return 0;
}

static void
say_head(const struct bench *b, const struct options *o)
{
    const struct cluster_spec *c = &o->cluster;

    printf("%s: %d x %d pixels, %u frame%s, -ps %d, %.2f s of one host\n",
           o->map.file ? o->map.file : "made-up costs", b->map.q.width,
           b->map.q.height, b->map.nframes, b->map.nframes > 1 ? "s" : "",
           b->map.psample, b->map.total);
    if (b->tiles.npasses > 0)
        printf("%s: %u passes, %.2f s of one host before the picture; %.2f s "
               "with a live cache\n",
               o->tiles, b->tiles.npasses, b->tiles.passes_s, b->tiles.live_s);
    printf("%d thread%s a host, speeds 1:%g, latency %g ms, %g Mbit/s, "
           "coordinator %g us a "
           "message, disk %g ms, load %g s\n",
           c->threads, c->threads > 1 ? "s" : "", c->uneven,
           1e-3 * c->latency_us, c->bandwidth / 125000, c->coord_us,
           1e-3 * c->disk_us, 1e-6 * c->load_us);
    printf("%g %% more work a doubling, %g failures of a host an hour, back "
           "after %g s\n",
           100 * c->growth, c->failures, 1e-6 * c->back_us);
    printf("One host alone: %.3f s\n", b->alone_s);
}

int
main(int argc, char *argv[])
{
    static struct bench b;
    struct rad_error err = { 0 };
    struct options o;
    char text[600];
    int rc;

    parse(&o, argc, argv);
    choose(&b, &o);
    rc = o.tiles ? take_tiles(&b, &o, &err) : 0;
    if (rc == 0)
        rc = map_init(&b.map, &o.map, &err);
    if (rc < 0) {
        rad_error_format(&err, text, sizeof text);
        die(rad_exit_status(rc), text, NULL);
    }
    simulate_alone(&b, &o);
    say_head(&b, &o);
    for (int k = 0; k < b.nways; k++)
        for (int i = 0; i < b.nhosts; i++) {
            simulate(&b, &o, b.ways[k], b.hosts[i], &b.result[k][i]);
            if (o.details)
                say_details(&b, b.ways[k], b.hosts[i], &b.result[k][i]);
            if (o.details && b.tiles.npasses > 0 && b.result[k][i].done)
                say_passes(&b.result[k][i]);
            if (o.timeline)
                say_timeline(&b.result[k][i]);
            fflush(stdout);
        }
    say_table(&b);
    puts("");
    for (int k = 0; k < b.nways; k++)
        say_limit(&b, k);
    if (o.plot)
        plot(&b, o.plot);
    map_release(&b.map);
    tiles_release(&b.tiles);
    return EX_OK;
}
