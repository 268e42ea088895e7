/* check_pointfile.c - lines of sensor points, as they come */
#include "config.h"

#include "points/pointfile.h"

#include "tests/unit.h"

#include <stdio.h>
#include <string.h>

#define A "1 0 0 0 0 1"
#define B "2 0 0 0 0 1"
#define MARK "\xef\xbb\xbf" /* byte-order mark */

static const struct {
    const char *text;
    uint32_t n;
    long wrong; /* the line that is an error; 0: none */
} texts[] = {
    { A "\n" B "\n", 2, 0 },      { A "\n" B, 2, 0 },
    { A " \r" B " \r", 2, 0 },    { A "\r\n" B "\r\n", 2, 0 },
    { A "\n\n\r\r" B, 2, 0 },     { A "\r\n\r\n" B "\r\nx", 2, 4 },
    { A "\r\r" B "\rx", 2, 4 },   { A "\n\n" B "\nx", 2, 4 },
    { A "\n\r" B "\n\rx", 2, 5 }, { A " " B "\r", 0, 1 },
    { MARK A "\n" B, 2, 0 },      { A "\n" MARK B, 1, 2 },
};

/* However it is cut in two. */
LOOP_TEST(newlines_and_returns_end_lines, N_ELEM(texts))
{
    const char *text = texts[_i].text;
    size_t len = strlen(text);

    for (size_t cut = 0; cut <= len; cut++) {
        struct rad_error err = { 0 };
        struct pointfile f;
        char where[32];
        size_t used;
        int rc;

        pointfile_init(&f, "p", 'a', UINT64_MAX);
        rc = pointfile_more(&f, text, cut, false, &used, &err);
        if (rc == 0)
            rc = pointfile_more(&f, text + used, len - used, true, &used, &err);
        ck_assert_uint_eq(f.n, texts[_i].n);
        ck_assert_int_eq(rc, texts[_i].wrong ? RAD_EDATA : 0);
        snprintf(where, sizeof where, "p:%ld", texts[_i].wrong);
        if (texts[_i].wrong)
            ck_assert_str_eq(err.where, where);
        for (uint32_t i = 0; i < f.n; i++)
            ck_assert_double_eq(f.point[i][0], i + 1.);
        pointfile_release(&f);
    }
}
