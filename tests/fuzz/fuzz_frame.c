/* fuzz_frame.c - the frame reader, and the decoder of whatever it lets pass
 *
 * The first byte chooses the session, the second the size of the pieces. */
#include "config.h"

#include "proto/frame.h"
#include "steps.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct frame_reader r;
    struct wire_out out;
    struct msg m = { 0 };
    struct rad_error err = { 0 };
    size_t piece;

    if (size < 2)
        return 0;
    frame_reader_init(&r, data[0] % MSG_NSESSION);
    wire_out_init(&out, MSG_FRAME_MAX);
    piece = data[1] + 1u;
    for (size_t at = 2; at < size; at += piece) {
        const uint8_t *p = data + at;
        size_t n = size - at < piece ? size - at : piece;
        int rc;

        while ((rc = frame_read(&r, &p, &n, &m, &err)) == 1) {
            steps_say(0, "says", msg_name(m.type));
            /* what was read can be written, but for a foreign HELLO */
            out.len = 0;
            if (msg_pack(&out, &m) != 0 && m.type != MSG_HELLO)
                abort();
        }
        if (rc < 0)
            steps_say(0, "breaks the protocol:", err.what);
        if (rc < 0)
            break;
    }
    frame_reader_release(&r);
    wire_out_release(&out);
    msg_release(&m);
    return 0;
}
