/* order.h - orders to a coordinator about a job, on a connection of their own
 *
 * Thread: the loop's. */
#ifndef RADD_CLIENT_ORDER_H
#define RADD_CLIENT_ORDER_H

#include "link/target.h"
#include "proto/message.h"

#include <uv.h>

/* Cancel a job of any state; delete a job that is over.  Returns 0, or the
 * error that kept the order from the coordinator. */
int order_cancel(const struct target *to, uv_loop_t *loop,
                 const uint8_t job[MSG_JOB]);
int order_delete(const struct target *to, uv_loop_t *loop,
                 const uint8_t job[MSG_JOB]);

#endif
