/* msg_order.c - the codec of what radsubmit and radctl ask the coordinator for
 *
 * FETCH to KEY in message.def, and ANSWER. */
#include "config.h"

#include "proto/codec.h"

void
msg_code_fetch(struct codec *c, struct msg_fetch *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frame);
    code_below(c, &b->what, MSG_NWHAT);
}

void
msg_code_query(struct codec *c, struct msg_query *b)
{
    code_below(c, &b->what, MSG_NQUERY);
    code_str(c, &b->text, MSG_MAX_NAME);
}

void
msg_code_page(struct codec *c, struct msg_page *b)
{
    code_below(c, &b->what, MSG_NROWS);
    code_below(c, &b->mine, 2);
    code_str(c, &b->user, MSG_MAX_NAME);
    code_str(c, &b->state, MSG_MAX_STATE);
    code_u64(c, &b->cursor);
    code_u32(c, &b->most);
}

void
msg_code_answer(struct codec *c, struct msg_answer *b)
{
    code_blob(c, &b->text, &b->len, MSG_MAX - 4);
}

void
msg_code_key(struct codec *c, struct msg_key *b)
{
    code_below(c, &b->what, MSG_NKEY);
    code_str(c, &b->name, MSG_MAX_KEY);
    code_u64(c, &b->expires);
    code_read_must(c, b->expires <= MSG_MAX_DATE);
}

void
msg_code_worker(struct codec *c, struct msg_worker *b)
{
    code_str(c, &b->name, MSG_MAX_NAME);
}

void
msg_code_drain(struct codec *c, struct msg_drain *b)
{
    code_str(c, &b->name, MSG_MAX_NAME);
    code_below(c, &b->why, MSG_NDRAIN);
}
