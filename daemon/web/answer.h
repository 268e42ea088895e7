/* answer.h - answers to browsers, with the headers that all answers have
 *
 * Thread: the loop's. */
#ifndef RADD_WEB_ANSWER_H
#define RADD_WEB_ANSWER_H

#include "observer/blob.h"
#include "observer/markup.h"

#include <microhttpd.h>

/* Queue a response, which is taken.  MHD_NO: it is NULL, or was not queued. */
enum MHD_Result answer_send(struct MHD_Connection *c, unsigned status,
                            const char *type, struct MHD_Response *response);
/* Queue a blob, whose reference is taken; a text, which is empty then. */
enum MHD_Result answer_blob(struct MHD_Connection *c, unsigned status,
                            const char *type, struct blob *b);
enum MHD_Result answer_text(struct MHD_Connection *c, unsigned status,
                            const char *type, struct markup *m);
/* Queue a page that says why the browser gets no other page at the path. */
enum MHD_Result answer_error(struct MHD_Connection *c, const char *path,
                             unsigned status, const char *text);

/* Make a blob of the text, and m empty; NULL: memory was out. */
struct blob *answer_made(struct markup *m);

#endif
