/* msg_job.c - the codec of the messages about a job as a whole: what it is, how
 * far it is, how it ended; its id as text
 *
 * See "jobs" in message.h. */
#include "config.h"

#include "codec.h"

#include "base/hex.h"

#include <float.h>

#define FRAME_MIN 15 /* bytes of a frame with an empty view */

static bool
frame_fits(const struct msg_frame *f)
{
    return f->width >= 1 && f->width <= MSG_MAX_SIDE && f->height >= 1 &&
           f->height <= MSG_MAX_SIDE;
}

static void
code_frames(struct codec *c, struct msg_spec *b)
{
    struct msg_frame *f = code_list(c, b->frames, &b->nframes, FRAME_MIN,
                                    MSG_MAX_FRAMES, sizeof *f);

    code_must(c, b->nframes >= 1);
    for (uint32_t i = 0; i < b->nframes; i++) {
        code_u32(c, &f[i].number);
        code_u32(c, &f[i].width);
        code_u32(c, &f[i].height);
        code_str(c, &f[i].view, MSG_MAX_VIEW);
        code_must(c, frame_fits(&f[i]));
    }
    b->frames = f;
}

/* The flags that a version has. */
static uint32_t
job_flags(unsigned version)
{
    return version < 2 ? MSG_JOB_FLAGS_1 : MSG_JOB_FLAGS;
}

/* Flags of ours in the words of the version that is written: those it does not
 * know are left out. */
static void
flags_as(struct codec *c, uint32_t *flags)
{
    code_must(c, (*flags & ~MSG_JOB_FLAGS) == 0);
    *flags &= job_flags(c->version);
}

/* Each a number, and not below 0. */
static bool
costs_fit(const struct msg_spec *b)
{
    for (uint32_t i = 0; i < b->ncosts; i++) {
        float cost;

        wire_floats_get(&cost, b->costs + (size_t)i * 4, 1);
        if (!(cost >= 0 && cost <= FLT_MAX))
            return false;
    }
    return true;
}

static void
code_costs(struct codec *c, struct msg_spec *b)
{
    code_count(c, &b->ncosts, 4, MSG_MAX_COSTS);
    code_view(c, &b->costs, (size_t)b->ncosts * 4);
    code_must(c, code_bad(c) || costs_fit(b));
}

void
msg_code_spec(struct codec *c, struct msg_spec *b)
{
    if (c->out)
        flags_as(c, &b->flags);
    code_job(c, &b->job);
    code_hash(c, &b->manifest);
    code_str(c, &b->name, MSG_MAX_NAME);
    code_str(c, &b->params, MSG_MAX_PARAMS);
    code_str(c, &b->needs, MSG_MAX_NEEDS);
    code_str(c, &b->estimate, MSG_MAX_NAME);
    code_costs(c, b);
    code_u64(c, &b->seed);
    code_i32(c, &b->priority);
    code_u32(c, &b->flags);
    code_below(c, &b->partition, MSG_NPART);
    code_below(c, &b->order, MSG_NORDER);
    code_u32(c, &b->windows);
    code_u32(c, &b->objects);
    code_u64(c, &b->bundle_bytes);
    code_amount(c, &b->compile_s);
    if (c->version >= 2)
        code_u32(c, &b->memory_mib);
    code_must(c, (b->flags & ~job_flags(c->version)) == 0);
    msg_code_hashes(c, &b->files);
    code_frames(c, b);
}

void
msg_code_accept(struct codec *c, struct msg_accept *b)
{
    code_job(c, &b->job);
    code_below(c, &b->again, 2);
}

/* A disk that is full is no state of version 1: the job waits. */
static uint8_t
state_as(unsigned version, uint8_t state)
{
    return version < 2 && state == MSG_STATE_HELD ? 0 : state;
}

void
msg_code_progress(struct codec *c, struct msg_progress *b)
{
    if (c->out)
        b->state = state_as(c->version, b->state);
    code_job(c, &b->job);
    code_u8(c, &b->state);
    code_u64(c, &b->pixels_done);
    code_u64(c, &b->pixels_total);
    code_u32(c, &b->units_done);
    code_u32(c, &b->units_total);
    code_u32(c, &b->units_redone);
    code_f64(c, &b->cost_done);
    code_f64(c, &b->cost_total);
    code_u64(c, &b->rays);
    code_u32(c, &b->workers);
    code_u32(c, &b->frames_ready);
    code_f64(c, &b->elapsed_s);
    code_u64(c, &b->nan.pixels);
    code_u32(c, &b->nan.frame);
    code_u32(c, &b->nan.x);
    code_u32(c, &b->nan.y);
    code_faults(c, b->faults);
    if (c->version >= 2)
        code_f64(c, &b->error);
}

void
msg_code_done(struct codec *c, struct msg_done *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frames);
}

void
msg_code_failed(struct codec *c, struct msg_failed *b)
{
    code_job(c, &b->job);
    code_u16(c, &b->status);
    code_str(c, &b->text, MSG_MAX_TEXT);
}

void
msg_code_jobid(struct codec *c, struct msg_jobid *b)
{
    code_job(c, &b->job);
}

/* --- its id --- */

void
msg_job_format(const uint8_t job[MSG_JOB], char hex[MSG_JOB_HEX])
{
    rad_hex_write(job, MSG_JOB, hex);
}

bool
msg_job_parse(const char *hex, uint8_t job[MSG_JOB])
{
    return rad_hex_valid(hex, MSG_JOB) && rad_hex_read(hex, MSG_JOB, job);
}
