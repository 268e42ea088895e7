/* fuzz_font.c - font files, and lines set with what came of them
 *
 * Up to the first NUL a font file, behind it a byte of spacing and a line. */
#include "scene/file/font.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *nul = size ? memchr(data, 0, size) : NULL;
    size_t len = nul ? (size_t)(nul - data) : size;
    struct rad_error err = { 0 };
    struct rad_textline line;
    struct rad_arena arena;
    struct rad_font *font;

    rad_arena_init(&arena);
    font = rad_font_parse(&arena, (const char *)data, len, &err);
    if (!font && err.code == 0)
        abort();
    if (font && nul && size - len > 2 &&
        rad_textline_set(&line, font, &arena, (const char *)nul + 2,
                         size - len - 2, (int8_t)nul[1], &err) == 0)
        for (double x = -1; x < 600; x += 7)
            for (double y = -1; y < 256; y += 31)
                rad_textline_inside(&line, x, y);
    rad_arena_release(&arena);
    return 0;
}
