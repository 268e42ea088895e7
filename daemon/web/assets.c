/* assets.c - see assets.h
 *
 * The assembler takes the files in as they are; make knows that this object is
 * made of them. */
#include "config.h"

#include "web/assets.h"

#include <string.h>

#define ASSET(name, file)                                                      \
    extern const char name[], name##_end[];                                    \
    __asm__(".section .rodata\n"                                               \
            ".global " #name "\n" #name ":\n"                                  \
            ".incbin \"" ASSETS_FOLDER "/" file "\"\n"                         \
            ".global " #name "_end\n" #name "_end:\n"                          \
            ".byte 0\n.previous\n")

ASSET(assets_style, "style.css");
ASSET(assets_page, "page.js");
ASSET(assets_icon, "icon.svg");

static const struct asset assets[] = {
    { "/style.css", "text/css; charset=utf-8", assets_style, assets_style_end },
    { "/page.js", "text/javascript; charset=utf-8", assets_page,
      assets_page_end },
    { "/icon.svg", "image/svg+xml", assets_icon, assets_icon_end },
};

const struct asset *
assets_find(const char *path)
{
    for (size_t i = 0; i < sizeof assets / sizeof assets[0]; i++)
        if (strcmp(assets[i].path, path) == 0)
            return &assets[i];
    return NULL;
}
