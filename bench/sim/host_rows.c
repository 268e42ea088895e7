/* host_rows.c - rows of pixels on their way to the coordinator */
#include "config.h"

#include "host_impl.h"

#include "image/hdr.h"

#include <stdlib.h>
#include <string.h>

/* Rows are sent when so many bytes of them are done, as in pool_unit.c. */
#define PIECE_BYTES (64u << 10)

/* Columns, in percent, whose mantissas are no run: so a coded pixel has 2.4
 * bytes, as in pictures of the office at night with bench/hosts.sh's options.
 */
#define NOISY 78

static void
send_tally(struct host *h)
{
    struct msg m = { .type = MSG_TALLY };

    m.tally.job = h->cluster->job;
    m.tally.busy_s = h->busy_s + h->wait_s;
    m.tally.wait_base_line_s = h->wait_s;
    host_say(h, &m);
}

size_t
host_rows_room(const struct host *h)
{
    return PIECE_BYTES + 2 * RAD_HDR_ROW_BYTES((size_t)host_map(h)->q.width);
}

uint32_t
host_rows_piece(struct host *h, uint32_t width)
{
    uint8_t *rgbe;

    if (h->code_width != width) {
        rgbe = sim_alloc(4 * (size_t)width);
        for (uint32_t i = 0; i < 4 * width * NOISY / 100; i++)
            rgbe[i] = i % 4 == 3 ? 128 : (uint8_t)(i * 2654435761u >> 24);
        h->row_bytes = rad_hdr_encode_rgbe(rgbe, (int)width, h->code);
        for (size_t n = h->row_bytes; n <= PIECE_BYTES; n += h->row_bytes)
            memcpy(h->code + n, h->code, h->row_bytes);
        h->code_width = width;
        free(rgbe);
    }
    return PIECE_BYTES / (uint32_t)h->row_bytes + 1;
}

void
host_rows_send(struct host *h, const struct msg_unit *u, uint32_t row,
               uint32_t rows, const struct msg_counts *counts)
{
    uint32_t most = host_rows_piece(h, u->width);
    struct msg m = { .type = MSG_RESULT };

    do {
        uint32_t n = rows < most ? rows : most;

        m.result = (struct msg_result){ .job = h->cluster->job,
                                        .unit = u->unit,
                                        .attempt = u->attempt,
                                        .row = row,
                                        .rows = n,
                                        .width = u->width,
                                        .channels = 1,
                                        .last = counts && n == rows,
                                        .pixels = h->code,
                                        .len = n * h->row_bytes };
        if (m.result.last) {
            m.result.counts = *counts;
            send_tally(h);
            h->units++;
        }
        host_say(h, &m);
        row += n;
        rows -= n;
    } while (rows > 0);
}
