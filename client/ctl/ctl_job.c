/* ctl_job.c - radctl's commands about one job */
#include "config.h"

#include "ctl/ctl.h"
#include "link/fetch.h"
#include "common/outname.h"
#include "base/output.h"
#include "base/number.h"
#include "show/picfile.h"
#include "show/spectra.h"
#include "common/table.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

enum {
    ANSWER_MS = 4500,
    AT_ONCE = 64 /* requests without answer: the disk's wait is shared */
};

/* Send the command's message about a job. */
static int
steer(struct ctl *c)
{
    struct msg m = { .type = (uint16_t)c->command->number };
    const struct msg *answer;
    uint8_t job[MSG_JOB];
    int rc = ctl_find_job(c, job);

    if (rc < 0)
        return rc;
    m.cancel.job = job; /* all these messages have the same struct */
    return ctl_ask(c, &m, &answer);
}

/* Take one of the answers that are due to requests first to c->request.  If a
 * job was ended or deleted meanwhile by someone else that is no failure. */
static int
take_answer(struct ctl *c, uint32_t first, unsigned *done)
{
    const struct msg *m;
    int rc;

    for (;;) {
        rc = link_recv(c->link, ANSWER_MS, &m, c->err);
        if (rc < 0)
            return rc;
        if (rc == 0)
            return rad_fail(c->err, RAD_EUNAVAIL,
                            "the coordinator does not answer");
        if (m->request < first || m->request > c->request)
            continue;
        if (m->type == MSG_ANSWER)
            ++*done;
        if (m->type == MSG_FAILED && m->failed.status != EX_USAGE &&
            m->failed.status != EX_NOINPUT)
            return rad_fail(c->err, link_code(m->failed.status), "%s",
                            m->failed.text);
        if (m->type == MSG_ANSWER || m->type == MSG_FAILED)
            return 0;
    }
}

/* Send the command's message for the job of each row, AT_ONCE at a time. */
static int
steer_rows(struct ctl *c, const json_t *rows, unsigned *done)
{
    uint32_t first = c->request + 1, answered = 0;
    size_t n = json_array_size(rows), sent = 0;
    uint8_t job[MSG_JOB];
    int rc = 0;

    while (rc == 0 && answered < n) {
        while (rc == 0 && sent < n && sent - answered < AT_ONCE) {
            struct msg m = { .type = (uint16_t)c->command->number,
                             .request = ++c->request,
                             .cancel = { job } };
            const char *id = json_string_value(
                json_object_get(json_array_get(rows, sent++), "job"));

            if (!id || !msg_job_parse(id, job))
                return rad_fail(c->err, RAD_EPROTO,
                                "the coordinator's answer names no job");
            rc = link_send(c->link, &m, c->err);
        }
        if (rc == 0)
            rc = take_answer(c, first, done);
        answered++;
    }
    return rc;
}

/* cancel --all, delete --all: the user's own jobs, or those of --user */
static int
steer_all(struct ctl *c)
{
    bool cancel = c->command->number == MSG_CANCEL;
    struct msg_page ask = { .what = MSG_ROWS_JOBS,
                            .mine = !c->user,
                            .state = cancel ? "open" : "over" };
    unsigned done = 0;
    json_t *rows;
    int rc;

    if ((rc = ctl_rows(c, &ask, &rows)) < 0)
        return rc;
    rc = steer_rows(c, rows, &done);
    json_decref(rows);
    if (rc == 0 && c->json)
        printf("{ \"ok\": true, \"jobs\": %u }\n", done);
    else if (rc == 0)
        printf("%u job%s %s\n", done, done == 1 ? "" : "s",
               cancel ? "cancelled" : "deleted");
    return rc;
}

int
ctl_run_job(struct ctl *c)
{
    int rc = c->all ? steer_all(c) : ctl_each(c, steer);

    return rc < 0 || c->all ? rc : ctl_done(c);
}

int
ctl_run_priority(struct ctl *c)
{
    struct msg m = { .type = MSG_PRIORITY };
    const struct msg *answer;
    uint8_t job[MSG_JOB];
    int n, rc;

    if (!c->name)
        return rad_fail(c->err, RAD_EUSAGE, "command 'priority': missing N");
    if (!rad_parse_int(c->name, &n) || n < -MSG_MOST_PRIORITY ||
        n > MSG_MOST_PRIORITY)
        return rad_fail(c->err, RAD_EUSAGE,
                        "priority: '%.80s' is no whole number from %d to %d",
                        c->name, -MSG_MOST_PRIORITY, MSG_MOST_PRIORITY);
    if ((rc = ctl_find_job(c, job)) < 0)
        return rc;
    m.priority.job = job;
    m.priority.priority = n;
    rc = ctl_ask(c, &m, &answer);
    return rc < 0 ? rc : ctl_done(c);
}

/* Get a whole file of a job; the caller frees its bytes. */
static int
fetch_file(struct ctl *c, const uint8_t job[MSG_JOB], int frame,
           enum msg_what what, struct rad_memory_out *f)
{
    const struct msg *m;
    int rc =
        fetch_start(c->link, job, (uint32_t)frame, what, ++c->request, c->err);

    while (rc == 0) {
        rc = link_recv(c->link, INT_MAX, &m, c->err);
        if (rc == 1)
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

    return rc < 0 ? rc : fetch_file(c, job, frame, MSG_WHAT_PICTURE, f);
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

    if (spectra_bands(&one, &b, NULL) < 0)
        return !is_spectra(c)
                   ? 0
                   : rad_fail(c->err, RAD_EUSAGE,
                              "'%s': spectra have more than three bands: name "
                              "the jobs of all planes of -cs",
                              c->output);
    if (b.plane != RAD_PLANE_COLOURS)
        return rad_fail(c->err, RAD_EUSAGE,
                        "job %s is plane %d of %d: name the jobs of all planes",
                        c->arg, b.plane + 1, rad_bands_planes(&b));
    *f = (struct rad_memory_out){ 0 };
    rc = join(c, &b, &one, f);
    free((void *)(uintptr_t)one.hdr);
    return rc;
}

/* --- pictures --- */

/* Get the picture of a frame; the caller frees its bytes. */
static int
get_picture(struct ctl *c, int frame, struct rad_memory_out *f)
{
    int rc;

    if (c->nargs > 1)
        return get_of_planes(c, frame, f);
    rc = get_of_job(c, frame, f);
    return rc < 0 ? rc : take_whole(c, f);
}

/* Let the first frame that is not black decide how this frame is shown, as it
 * does when all frames are fetched together. */
static int
look_at_first(struct ctl *c, int frame)
{
    int rc = 0;

    for (int i = 0; rc == 0 && i < frame && show_waits(&c->show); i++) {
        struct rad_memory_out f = { 0 };

        rc = get_picture(c, i, &f);
        if (rc == 0)
            rc = picfile_look(f.bytes, f.len, &c->show, c->err);
        free(f.bytes);
    }
    return rc;
}

/* Path NULL: standard output. */
static int
fetch_picture(struct ctl *c, int frame, const char *path)
{
    struct rad_memory_out f = { 0 };
    int rc = get_picture(c, frame, &f);

    if (rc == 0)
        rc = picfile_write(path, PICFILE_BY_SUFFIX, f.bytes, f.len, true,
                           &c->show, c->err);
    free(f.bytes);
    return rc;
}

/* Get all frames, into files with their numbers. */
static int
fetch_all(struct ctl *c)
{
    const struct msg *answer;
    int rc = ctl_query(c, MSG_QUERY_JOB, c->arg, &answer);
    json_t *state = rc < 0 ? NULL : ctl_parse(c, answer);
    json_int_t n = json_integer_value(json_object_get(state, "frames"));

    json_decref(state);
    if (!state)
        return c->err->code;
    for (int i = 0; i < n && rc == 0; i++) {
        char *name = NULL;

        rc = outname_frame(&name, c->output, i, true, c->err);
        if (rc == 0)
            rc = fetch_picture(c, i, name);
        free(name);
    }
    return rc;
}

static int
fetch_one(struct ctl *c)
{
    int frame = c->frame < 0 ? 0 : c->frame;
    int rc = picfile_is_png(c->output, PICFILE_BY_SUFFIX)
                 ? look_at_first(c, frame)
                 : 0;

    return rc < 0 ? rc : fetch_picture(c, frame, c->output);
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

static int
fetch(struct ctl *c)
{
    int rc = c->output ? rad_output_check(c->output, c->err) : 0;

    if (rc < 0)
        return rc;
    rc = c->frame < 0 && is_numbered(c->output) ? fetch_all(c) : fetch_one(c);
    return rc < 0 || !c->output ? rc : ctl_done(c);
}

int
ctl_run_fetch(struct ctl *c)
{
    char *name = NULL;
    int rc = 0;

    if (c->frame >= 0 && is_numbered(c->output))
        rc = outname_frame(&name, c->output, c->frame, true, c->err);
    if (name)
        c->output = name;
    if (rc == 0)
        rc = fetch(c);
    free(name);
    return rc;
}

/* Add the job's state to its statistics. */
static int
add_state(struct ctl *c, json_t *stats)
{
    const struct msg *answer;
    json_t *state;
    int rc = ctl_query(c, MSG_QUERY_JOB, c->arg, &answer);

    if (rc < 0)
        return rc;
    state = ctl_parse(c, answer);
    if (!state)
        return c->err->code;
    json_object_update_missing(stats, state);
    json_decref(state);
    return 0;
}

/* job: a summary for people; with --json the statistics so far and the state.
 */
int
ctl_run_job_report(struct ctl *c)
{
    struct rad_memory_out f = { 0 };
    uint8_t job[MSG_JOB];
    json_t *stats = NULL;
    int rc;

    if (!c->json)
        return ctl_run_query(c);
    if ((rc = ctl_find_job(c, job)) < 0)
        return rc;
    rc = fetch_file(c, job, 0, MSG_WHAT_STATS, &f);
    if (rc == 0) {
        stats = json_loadb((const char *)f.bytes, f.len, 0, NULL);
        rc = stats ? add_state(c, stats)
                   : rad_fail(c->err, RAD_EPROTO, "the statistics are no JSON");
    }
    if (rc == 0) {
        table_print_json(stdout, stats);
    }
    json_decref(stats);
    free(f.bytes);
    return rc;
}
