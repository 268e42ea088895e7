/* order.h - what a coordinator is told about a job, on a connection of its own
 *
 * Thread: the loop's. */
#ifndef RADD_CLIENT_ORDER_H
#define RADD_CLIENT_ORDER_H

#include "link/target.h"
#include "proto/message.h"

#include <uv.h>

/* Cancel a job that somebody has submitted, whatever state it is in, or delete
 * one that is over: 0, or what keeps the coordinator from hearing of it. */
int order_cancel(const struct target *to, uv_loop_t *loop,
                 const uint8_t job[MSG_JOB]);
int order_delete(const struct target *to, uv_loop_t *loop,
                 const uint8_t job[MSG_JOB]);

#endif
