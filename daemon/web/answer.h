/* answer.h - answers to browsers, with the headers that all have
 *
 * Thread: the loop's. */
#ifndef RADD_WEB_ANSWER_H
#define RADD_WEB_ANSWER_H

#include "draw/markup.h"
#include "observer/blob.h"

#include <microhttpd.h>

/* Queue a response, which is taken; MHD_NO when it is NULL. */
enum MHD_Result answer_send(struct MHD_Connection *c, unsigned status,
                            const char *type, struct MHD_Response *response);
/* The same of bytes, by a reference that is taken; and of a text that has
 * grown, which is empty then. */
enum MHD_Result answer_blob(struct MHD_Connection *c, unsigned status,
                            const char *type, struct blob *b);
enum MHD_Result answer_text(struct MHD_Connection *c, unsigned status,
                            const char *type, struct markup *m);
/* A page that says why there is none. */
enum MHD_Result answer_error(struct MHD_Connection *c, unsigned status,
                             const char *text);

/* What has grown, to be shared; NULL when memory was out. */
struct blob *answer_made(struct markup *m);

#endif
