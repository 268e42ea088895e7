/* answer.h - answers to browsers, with the headers that all have
 *
 * Thread: the loop's. */
#ifndef RADD_WEB_ANSWER_H
#define RADD_WEB_ANSWER_H

#include "draw/markup.h"
#include "observer/blob.h"

#include <microhttpd.h>

/* Queue a response; takes it.  MHD_NO if it is NULL. */
enum MHD_Result answer_send(struct MHD_Connection *c, unsigned status,
                            const char *type, struct MHD_Response *response);
/* The same of a blob, whose reference is taken; of a text, which is empty then.
 */
enum MHD_Result answer_blob(struct MHD_Connection *c, unsigned status,
                            const char *type, struct blob *b);
enum MHD_Result answer_text(struct MHD_Connection *c, unsigned status,
                            const char *type, struct markup *m);
/* A page that says why there is no other. */
enum MHD_Result answer_error(struct MHD_Connection *c, unsigned status,
                             const char *text);

/* Make the text a blob, and m empty; NULL: memory was out. */
struct blob *answer_made(struct markup *m);

#endif
