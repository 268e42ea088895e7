/* shown.c - the light of a screen, for tests in shell
 *
 * shown FILE.png               what the file is: its width, height, bits of a
 *                              channel, intent of its chunk sRGB (-1: none) and
 *                              gamma (0: none), then a line a pixel
 * shown TONE EXPOSURE FILE.hdr what the tone curve makes of the picture, words
 *                              as of --tone and --exposure
 * A pixel is a line of red, green, blue, linear, 1 is white. */
#include "config.h"

#include "show/show.h"

#include "base/files.h"
#include "tone/primaries.h"

#include <limits.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double
linear(unsigned v, int bits)
{
    double s = v / (bits == 16 ? 65535. : 255.);

    return s <= .04045 ? s / 12.92 : pow((s + .055) / 1.055, 2.4);
}

static void
print_row(const png_byte *row, int width, int bits)
{
    for (int i = 0; i < 3 * width; i++) {
        unsigned v =
            bits == 16 ? (unsigned)(row[2 * i] << 8 | row[2 * i + 1]) : row[i];

        printf("%.9g%c", linear(v, bits), i % 3 == 2 ? '\n' : ' ');
    }
}

static int
show_png(const char *path)
{
    FILE *f = fopen(path, "rb");
    png_structp png =
        png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    int width, height, bits, intent = -1;
    double gamma = 0;

    if (!f || !info || setjmp(png_jmpbuf(png)))
        return 1;
    png_init_io(png, f);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    width = (int)png_get_image_width(png, info);
    height = (int)png_get_image_height(png, info);
    bits = png_get_bit_depth(png, info);
    png_get_sRGB(png, info, &intent);
    png_get_gAMA(png, info, &gamma);
    printf("%d %d %d %d %.5f\n", width, height, bits, intent, gamma);
    for (int y = 0; y < height; y++)
        print_row(png_get_rows(png, info)[y], width, bits);
    png_destroy_read_struct(&png, &info, NULL);
    fclose(f);
    return 0;
}

static int
print_shown(const struct show *s, const struct rad_picture *pic,
            const struct rad_view *view, struct rad_error *err)
{
    struct rad_rgb *row = malloc((size_t)pic->width * sizeof *row);
    struct rad_tone tone = { 0 };
    struct rad_toner toner;
    int rc = rad_toner_init(&toner, &s->screen.tone, &tone, pic, view, err);

    for (int y = 0; rc == 0 && y < pic->height; y++) {
        rad_toner_row(&toner, y, row);
        for (int x = 0; x < pic->width; x++)
            printf("%.9g %.9g %.9g\n", (double)row[x].r, (double)row[x].g,
                   (double)row[x].b);
    }
    rad_toner_release(&toner);
    free(row);
    return rc;
}

static int
show_hdr(char *argv[], struct rad_error *err)
{
    struct show s;
    struct rad_picture pic;
    struct rad_view view;
    bool known;
    size_t len;
    unsigned char *hdr;
    int rc;

    show_init(&s);
    rad_view_init(&view);
    if ((rc = show_tone(&s, argv[1], err)) < 0 ||
        (rc = show_exposure(&s, argv[2], err)) < 0)
        return rc;
    if (!(hdr = rad_file_read(argv[3], INT_MAX, &len, err)))
        return err->code;
    known = rad_view_read(&view, (const char *)hdr, len, NULL) > 0 &&
            rad_view_setup(&view, NULL) == 0;
    if ((rc = rad_hdr_read(hdr, len, INT_MAX, &pic, err)) == 0) {
        rad_primaries_convert(&pic);
        rc = print_shown(&s, &pic, known ? &view : NULL, err);
    }
    rad_picture_release(&pic);
    free(hdr);
    return rc;
}

int
main(int argc, char *argv[])
{
    struct rad_error err = { 0 };
    char text[600];

    if (argc == 2)
        return show_png(argv[1]);
    if (argc != 4)
        return 64;
    if (show_hdr(argv, &err) == 0)
        return 0;
    rad_error_format(&err, text, sizeof text);
    fprintf(stderr, "shown: %s\n", text);
    return 1;
}
