/* answer.c - see answer.h */
#include "config.h"

#include "web/answer.h"

#include "web/page.h"

static const char *const headers[][2] = {
    { "Content-Security-Policy",
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' "
      "blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
      "frame-ancestors 'none'" },
    { "X-Content-Type-Options", "nosniff" },
    { "Referrer-Policy", "no-referrer" },
    { "Cross-Origin-Resource-Policy", "same-origin" },
    { "Cross-Origin-Opener-Policy", "same-origin" },
    { "Cache-Control", "no-store" },
};

enum MHD_Result
answer_send(struct MHD_Connection *c, unsigned status, const char *type,
            struct MHD_Response *response)
{
    enum MHD_Result rc;

    if (!response)
        return MHD_NO;
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
        MHD_add_response_header(response, headers[i][0], headers[i][1]);
    MHD_add_response_header(response, MHD_HTTP_HEADER_CONTENT_TYPE, type);
    if (status == MHD_HTTP_UNAUTHORIZED)
        MHD_add_response_header(response, MHD_HTTP_HEADER_WWW_AUTHENTICATE,
                                "Basic realm=\"radweb\", charset=\"UTF-8\"");
    if (status == MHD_HTTP_METHOD_NOT_ALLOWED)
        MHD_add_response_header(response, MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
    if (status == MHD_HTTP_SERVICE_UNAVAILABLE) {
        MHD_add_response_header(response, MHD_HTTP_HEADER_RETRY_AFTER, "10");
        MHD_add_response_header(response, "Refresh", "10"); /* browsers do */
    }
    rc = MHD_queue_response(c, status, response);
    MHD_destroy_response(response);
    return rc;
}

static void
free_blob(void *arg)
{
    blob_unref(arg);
}

enum MHD_Result
answer_blob(struct MHD_Connection *c, unsigned status, const char *type,
            struct blob *b)
{
    struct MHD_Response *response =
        b ? MHD_create_response_from_buffer_with_free_callback_cls(
                b->len, b->bytes, free_blob, b)
          : NULL;

    if (!response)
        blob_unref(b);
    return answer_send(c, status, type, response);
}

struct blob *
answer_made(struct markup *m)
{
    size_t n = 0;
    char *text = markup_take(m, &n);

    return blob_new(text, n);
}

enum MHD_Result
answer_text(struct MHD_Connection *c, unsigned status, const char *type,
            struct markup *m)
{
    return answer_blob(c, status, type, answer_made(m));
}

enum MHD_Result
answer_error(struct MHD_Connection *c, const char *path, unsigned status,
             const char *text)
{
    struct markup m = { 0 };

    page_error(&m, path, status, text);
    return answer_text(c, status, "text/html; charset=utf-8", &m);
}
