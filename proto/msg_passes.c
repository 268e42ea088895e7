/* msg_passes.c - the codec of the messages of passes; see msg_passes.h */
#include "config.h"

#include "proto/codec.h"

static void
code_tile(struct codec *c, uint32_t *pass, uint32_t *tile)
{
    code_u32(c, pass);
    code_u32(c, tile);
    code_read_must(c, *pass < MSG_MOST_PASSES && *tile < MSG_MOST_TILES);
}

void
msg_code_tile(struct codec *c, struct msg_tile *b)
{
    code_job(c, &b->job);
    code_tile(c, &b->pass, &b->tile);
    code_below(c, &b->colours, 2);
}

void
msg_code_tile_made(struct codec *c, struct msg_tile_made *b)
{
    code_job(c, &b->job);
    code_tile(c, &b->pass, &b->tile);
    code_counts(c, &b->counts);
    code_u32(c, &b->count);
    code_blob(c, &b->data, &b->len, MSG_MAX_TILE);
    code_blob(c, &b->colours, &b->colours_len, MSG_MAX_COLOURS);
    code_read_must(c, b->count <= b->len && b->colours_len % 4 == 0);
}

void
msg_code_frozen(struct codec *c, struct msg_frozen *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->pass);
    code_u32(c, &b->first);
    code_below(c, &b->last, 2);
    code_u32(c, &b->count);
    code_blob(c, &b->data, &b->len, MSG_MAX_TILE);
    code_read_must(c, b->pass < MSG_MOST_PASSES && b->count <= b->len);
}

void
msg_code_tile_records(struct codec *c, struct msg_tile_records *b)
{
    code_job(c, &b->job);
    code_tile(c, &b->pass, &b->tile);
    code_u32(c, &b->count);
    code_blob(c, &b->data, &b->len, MSG_MAX_TILE);
    code_read_must(c, b->count <= b->len);
}

void
msg_code_closed(struct codec *c, struct msg_closed *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->pass);
    code_u32(c, &b->count);
    code_u64(c, &b->sum);
    code_below(c, &b->asks, 2);
    code_read_must(c, b->pass < MSG_MOST_PASSES);
}

void
msg_code_holds(struct codec *c, struct msg_holds *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->pass);
    code_below(c, &b->whole, 2);
    code_read_must(c, b->pass < MSG_MOST_PASSES);
}

void
msg_code_feed(struct codec *c, struct msg_feed *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->n);
    code_must(c, b->n <= MSG_MOST_FED);
    for (uint32_t i = 0; i < b->n && !code_bad(c); i++)
        code_str(c, &b->name[i], MSG_MAX_NAME);
}

void
msg_code_stage(struct codec *c, struct msg_stage *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->pass);
    code_str(c, &b->params, MSG_MAX_PARAMS);
    code_read_must(c, b->pass < MSG_MOST_PASSES);
}
