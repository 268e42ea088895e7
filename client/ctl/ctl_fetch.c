/* ctl_fetch.c - radctl fetch: pictures of jobs
 *
 * The coordinator knows the frames of an animation by their places, from 0.
 * People know them by the numbers that -S of radsubmit gave them, which name
 * files, too; each picture's header has its own.  Numbers rise with places,
 * with gaps where --no-clobber left frames out. */
#include "config.h"

#include "ctl/ctl.h"
#include "common/outname.h"
#include "link/fetch.h"
#include "show/picfile.h"
#include "show/spectra.h"

#include "base/output.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int
ctl_fetch_file(struct ctl *c, const uint8_t job[MSG_JOB], int frame,
               enum msg_what what, int wait_ms, struct rad_memory_out *f)
{
    const struct msg *m;
    int rc =
        fetch_start(c->link, job, (uint32_t)frame, what, ++c->request, c->err);

    while (rc == 0) {
        rc = link_recv(c->link, wait_ms, &m, c->err);
        if (rc == 0)
            rc = rad_fail(c->err, RAD_EUNAVAIL,
                          "the coordinator does not answer");
        else if (rc == 1)
            rc = m->request == c->request ? fetch_take(f, m, c->err) : 0;
    }
    uv_update_time(&c->loop);
    c->start_ms = uv_now(&c->loop); /* a file may take any time */
    return rc < 0 ? rc : 0;
}

/* Get a frame of the job that c->arg names. */
static int
get_of_job(struct ctl *c, int frame, struct rad_memory_out *f)
{
    uint8_t job[MSG_JOB];
    int rc = ctl_find_job(c, job);

    return rc < 0 ? rc
                  : ctl_fetch_file(c, job, frame, MSG_WHAT_PICTURE, INT_MAX, f);
}

/* --- planes --- */

struct plane_set {
    struct spectra_plane plane[RAD_MAX_PLANES];
    struct rad_bands bands;
    int n;
};

/* Add the next plane; the set takes its bytes. */
static int
add_plane(struct ctl *c, struct plane_set *s, const struct rad_memory_out *f)
{
    struct spectra_plane one = { f->bytes, f->len };
    struct rad_bands b;
    int rc = spectra_bands(&one, &b, c->err);

    if (rc < 0)
        return rc;
    if (b.plane == RAD_PLANE_COLOURS)
        return rad_fail(c->err, RAD_EUSAGE,
                        "job %s shows all bands: name that one alone", c->arg);
    if (s->n > 0 && (b.n != s->bands.n || b.longest != s->bands.longest ||
                     b.shortest != s->bands.shortest))
        return rad_fail(c->err, RAD_EDATA,
                        "job %s has other bands than the first", c->arg);
    if (s->plane[b.plane].hdr)
        return rad_fail(c->err, RAD_EDATA,
                        "job %s shows a plane that another has shown", c->arg);
    s->bands = b;
    s->plane[b.plane] = one;
    s->n++;
    return 0;
}

static int
get_planes(struct ctl *c, int frame, struct plane_set *s)
{
    int rc = 0;

    for (int i = 0; i < c->nargs && rc == 0; i++) {
        struct rad_memory_out f = { 0 };

        c->arg = c->args[i];
        rc = get_of_job(c, frame, &f);
        if (rc == 0)
            rc = add_plane(c, s, &f);
        if (rc < 0)
            free(f.bytes);
    }
    if (rc == 0 && s->n < rad_bands_planes(&s->bands))
        rc = rad_fail(c->err, RAD_EUSAGE,
                      "-cs %d has %d planes, a job each, and these are %d",
                      s->bands.n, rad_bands_planes(&s->bands), s->n);
    return rc;
}

/* Is the output a file of spectra, of all bands of the planes? */
static bool
is_spectra(const struct ctl *c)
{
    return c->output && outname_suffix(c->output, ".hsr");
}

/* Put a frame's planes together, as spectra or as colours. */
static int
join(struct ctl *c, const struct rad_bands *bands,
     const struct spectra_plane plane[], struct rad_memory_out *f)
{
    struct spectra_order order = { *bands, is_spectra(c), RAD_PRIM_RGB };

    return spectra_join(&order, plane, &f->bytes, &f->len, c->err);
}

/* Get a frame of several jobs, each of which is a plane of it. */
static int
get_of_planes(struct ctl *c, int frame, struct rad_memory_out *f)
{
    struct plane_set s = { .n = 0 };
    int rc = get_planes(c, frame, &s);

    if (rc == 0)
        rc = join(c, &s.bands, s.plane, f);
    for (int k = 0; k < RAD_MAX_PLANES; k++)
        free((void *)(uintptr_t)s.plane[k].hdr);
    return rc;
}

/* Make f, a frame of one job, what is to be written: as it is, or all bands of
 * which it is the only plane. */
static int
take_whole(struct ctl *c, struct rad_memory_out *f)
{
    struct spectra_plane one = { f->bytes, f->len };
    struct rad_bands b;
    int rc;

    if (c->plane)
        return 0;
    if (spectra_bands(&one, &b, NULL) < 0)
        return !is_spectra(c)
                   ? 0
                   : rad_fail(c->err, RAD_EUSAGE,
                              "'%s': spectra have more than three bands: name "
                              "the jobs of all planes of -cs",
                              c->output);
    if (b.plane != RAD_PLANE_COLOURS)
        return rad_fail(c->err, RAD_EUSAGE,
                        "job %s is plane %d of %d: name the jobs of all "
                        "planes, or use --plane",
                        c->arg, b.plane + 1, rad_bands_planes(&b));
    *f = (struct rad_memory_out){ 0 };
    rc = join(c, &b, &one, f);
    free((void *)(uintptr_t)one.hdr);
    return rc;
}

/* --- pictures --- */

/* Get the picture at that place among the frames; the caller frees its bytes.
 */
static int
get_picture(struct ctl *c, int frame, struct rad_memory_out *f)
{
    int rc;

    if (c->nargs > 1)
        return get_of_planes(c, frame, f);
    rc = get_of_job(c, frame, f);
    return rc < 0 ? rc : take_whole(c, f);
}

/* The number of a picture's frame, from the picture's header; 0: a still. */
static int
frame_number(const struct rad_memory_out *f)
{
    static const char key[] = "\nFRAME=";
    const uint8_t *end = memmem(f->bytes, f->len, "\n\n", 2);
    const uint8_t *at =
        end ? memmem(f->bytes, (size_t)(end - f->bytes), key, strlen(key))
            : NULL;

    /* the header ends with an empty line, so strtol() ends before it */
    return at ? (int)strtol((const char *)at + strlen(key), NULL, 10) : 0;
}

/* Ask how many frames the job has, and how many of them are ready. */
static int
count_frames(struct ctl *c, int *n, int *ready)
{
    const struct msg *answer;
    int rc = ctl_query(c, MSG_QUERY_JOB, c->args[0], &answer);
    json_t *state = rc < 0 ? NULL : ctl_parse(c, answer);

    if (!state)
        return c->err->code;
    *n = (int)json_integer_value(json_object_get(state, "frames"));
    *ready = (int)json_integer_value(json_object_get(state, "frames_ready"));
    json_decref(state);
    return 0;
}

static int64_t
within(int64_t v, int64_t lo, int64_t hi)
{
    return v < lo ? lo : v > hi ? hi : v;
}

/* Find the place of the frame of that number and get its picture, which the
 * caller frees.  The first guess is right if frames are numbered from 1. */
static int
get_numbered(struct ctl *c, int number, int *place, struct rad_memory_out *f)
{
    int n, ready, rc = count_frames(c, &n, &ready);
    int64_t lo = 0, hi, at;

    if (rc < 0)
        return rc;
    hi = n - 1;
    at = within((int64_t)number - 1, 0, within(ready - 1, 0, hi));
    while (lo <= hi) {
        int is;

        if ((rc = get_picture(c, (int)at, f)) < 0)
            return rc;
        is = frame_number(f);
        *place = (int)at;
        if (is == number)
            return 0;
        free(f->bytes);
        *f = (struct rad_memory_out){ 0 };
        if (is < number)
            lo = at + 1;
        else
            hi = at - 1;
        at = within(at + number - is, lo, hi);
    }
    return rad_fail(c->err, RAD_EUSAGE, "no such frame: %d", number);
}

/* Let the first frame that is not black decide how the frame at that place is
 * shown, as it does when all frames are fetched together. */
static int
look_at_first(struct ctl *c, int place)
{
    int rc = 0;

    if (!picfile_is_png(c->output, PICFILE_BY_SUFFIX))
        return 0;
    for (int i = 0; rc == 0 && i < place && show_waits(&c->show); i++) {
        struct rad_memory_out f = { 0 };

        rc = get_picture(c, i, &f);
        if (rc == 0)
            rc = picfile_look(f.bytes, f.len, &c->show, c->err);
        free(f.bytes);
    }
    return rc;
}

/* Does the output's name have a place for the frame's number? */
static bool
is_numbered(const char *output)
{
    char *name = NULL;
    bool numbered = output && outname_frame(&name, output, 0, true, NULL) == 0;

    free(name);
    return numbered;
}

/* Write a picture to standard output or to the output file, in whose name its
 * number stands for a %d. */
static int
put(struct ctl *c, const struct rad_memory_out *f)
{
    char *name = NULL;
    int rc = 0;

    if (is_numbered(c->output))
        rc = outname_frame(&name, c->output, frame_number(f), true, c->err);
    if (rc == 0) {
        struct picfile to = { .path = name ? name : c->output,
                              .durable = true };

        rc = picfile_write(&to, f->bytes, f->len, &c->show, c->err);
    }
    free(name);
    return rc;
}

static int
fetch_all(struct ctl *c)
{
    int n, ready, rc = count_frames(c, &n, &ready);

    for (int i = 0; rc == 0 && i < n; i++) {
        struct rad_memory_out f = { 0 };

        rc = get_picture(c, i, &f);
        if (rc == 0)
            rc = put(c, &f);
        else if (n > 1)
            rad_error_where(c->err, "%d of %d pictures are written", i, n);
        free(f.bytes);
    }
    return rc;
}

/* Get the picture of --frame, or else the first. */
static int
fetch_one(struct ctl *c)
{
    struct rad_memory_out f = { 0 };
    int place = 0, rc = c->frame < 0 ? get_picture(c, 0, &f)
                                     : get_numbered(c, c->frame, &place, &f);

    if (rc == 0)
        rc = look_at_first(c, place);
    if (rc == 0)
        rc = put(c, &f);
    free(f.bytes);
    return rc;
}

/* Can the file be written?  Not known of a name that waits for a number. */
static int
check_file(struct ctl *c)
{
    char *name = NULL;
    int rc;

    if (!is_numbered(c->output))
        return rad_output_check(c->output, c->err);
    if (c->frame < 0)
        return 0;
    rc = outname_frame(&name, c->output, c->frame, true, c->err);
    if (rc == 0)
        rc = rad_output_check(name, c->err);
    free(name);
    return rc;
}

/* Set how a .png shows the picture. */
static int
check_show(struct ctl *c)
{
    struct show_asked asked = { c->tone != NULL, c->bits != NULL, c->exposure,
                                c->false_colour };
    const char *given;
    int rc = show_first(&asked, &given, c->err);

    if (rc < 0)
        return rc;
    if (given && !picfile_is_png(c->output, PICFILE_BY_SUFFIX))
        return rad_fail(c->err, RAD_EUSAGE, "%s is for fetch with -o FILE.png",
                        given);
    if (c->tone)
        rc = show_tone(&c->show, c->tone, c->err);
    if (rc == 0 && c->bits)
        rc = show_bits(&c->show, c->bits, c->err);
    return rc == 0 ? show_take(&c->show, &asked, c->err) : rc;
}

int
ctl_check_fetch(struct ctl *c)
{
    int rc;

    if (c->output && strcmp(c->output, "-") == 0)
        c->output = NULL;
    if ((rc = check_show(c)) < 0)
        return rc;
    if (c->plane && c->nargs > 1)
        return rad_fail(c->err, RAD_EUSAGE, "fetch: --plane is for one job");
    if (c->plane && is_spectra(c))
        return rad_fail(c->err, RAD_EUSAGE,
                        "'%s': --plane gets three bands alone, and spectra "
                        "have more",
                        c->output);
    if (c->json && !c->output)
        return rad_fail(c->err, RAD_EUSAGE, "fetch: --json needs -o");
    if (!c->output)
        return 0;
    rc = picfile_check(c->output, false, c->err);
    return rc < 0 ? rc : check_file(c);
}

int
ctl_run_fetch(struct ctl *c)
{
    bool all = c->frame < 0 && is_numbered(c->output);
    int rc = all ? fetch_all(c) : fetch_one(c);

    return rc < 0 || !c->output ? rc : ctl_done(c);
}
