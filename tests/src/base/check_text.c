/* check_text.c - tests of src/base/text: what others wrote, on our terminal */
#include "config.h"

#include "base/error.h"
#include "base/text.h"
#include "tests/unit.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *text, *clean;
} cleaned[] = {
    { "", "" },
    { "office.rad", "office.rad" },
    { "Büro, 事務所, été", "Büro, 事務所, été" },
    { "e\xcc\x81t", "e\xcc\x81t" }, /* combining: a letter as good as any */
    { "a\033[2Jb", "a?[2Jb" },      /* ESC */
    { "a\rb\nc\td", "a?b?c?d" },
    { "a\x7f"
      "b",
      "a?b" },
    { "a\xc2\x9b"
      "2Jb",
      "a?2Jb" },                  /* U+009B, CSI as one character */
    { "\xc2\x80\xc2\x9f", "??" }, /* first and last of C1 */
    { "\xc2\xa0", "\xc2\xa0" },   /* U+00A0 is none */
    { "a\x9b"
      "2J",
      "a?2J" },                            /* a bare byte of C1 */
    { "caf\xe9", "caf?" },                 /* Latin-1 */
    { "\xe2\x80\xaegnp.exe", "?gnp.exe" }, /* U+202E, right to left */
    { "\xe2\x80\xaa\xe2\x80\xad", "??" },
    { "\xe2\x81\xa6\xe2\x81\xa9", "??" }, /* U+2066, U+2069 */
    { "\xe2\x80\x8e\xe2\x80\x8f", "??" }, /* U+200E, U+200F */
    { "\xe2\x80\xa8\xe2\x80\xa9", "??" }, /* U+2028, U+2029 */
    { "a\xe2\x80\x8b\xef\xbb\xbf"
      "b",
      "a??b" },                         /* zero width */
    { "\xd8\x9c", "?" },                /* U+061C */
    { "\xf3\xa0\x81\x81", "?" },        /* U+E0041, a tag */
    { "\xe2\x80\x90", "\xe2\x80\x90" }, /* U+2010, a hyphen */
    { "\xc0\x9b", "??" },               /* overlong */
    { "\xed\xa0\x80", "???" },          /* a surrogate */
    { "a\xe4\xba", "a??" },             /* half a character */
};

LOOP_TEST(text_of_others_is_made_safe, N_ELEM(cleaned))
{
    char text[64];

    strcpy(text, cleaned[_i].text);
    rad_text_clean(text);
    ck_assert_str_eq(text, cleaned[_i].clean);
}

static const struct {
    const char *text, *trimmed;
} trimmed[] = {
    { "", "" },       { "ab", "ab" },       { "aé", "aé" },
    { "a\xc3", "a" }, { "a\xe4\xba", "a" }, { "a\xf0\x9f\x98", "a" },
    { "a事", "a事" }, { "a\x9b", "a\x9b" }, /* no part of a character that was
                                               cut */
    { "\xe4", "" },
};

LOOP_TEST(cut_text_ends_with_a_whole_character, N_ELEM(trimmed))
{
    char text[64];

    strcpy(text, trimmed[_i].text);
    rad_text_trim(text);
    ck_assert_str_eq(text, trimmed[_i].trimmed);
}

static const struct {
    const char *text;
    size_t width, columns, bytes; /* bytes of so many columns */
} widths[] = {
    { "", 0, 5, 0 },
    { "abc", 3, 2, 2 },
    { "été", 3, 2, 3 },
    { "事務所", 6, 3, 3 }, /* half of the second does not fit */
    { "事務所", 6, 4, 6 },
    { "e\xcc\x81t", 2, 1, 3 },
    { "한글", 4, 9, 6 },
    { "\xf0\x9f\x98\x80", 2, 1, 0 },
};

LOOP_TEST(width_counts_columns, N_ELEM(widths))
{
    ck_assert_uint_eq(rad_text_width(widths[_i].text), widths[_i].width);
    ck_assert_uint_eq(rad_text_fit(widths[_i].text, widths[_i].columns),
                      widths[_i].bytes);
}

TEST(json_says_the_same_without_what_a_terminal_obeys)
{
    static const char text[] = "{\n \"é\": \"a\xc2\x9b\x7f\xe2\x80\xae"
                               "\xf3\xa0\x81\x81\"\n}";
    char out[RAD_TEXT_JSON_ROOM(sizeof text - 1)];

    rad_text_json(text, sizeof text - 1, out);
    ck_assert_str_eq(out, "{\n \"é\": \"a\\u009b\\u007f\\u202e"
                          "\\udb40\\udc41\"\n}");
}

TEST(message_is_cut_between_characters)
{
    struct rad_error err = { 0 };
    char buf[600], name[400];

    for (int shift = 0; shift < 3; shift++) {
        size_t n = (size_t)shift;

        memset(name, 'x', n);
        for (; n + 3 < sizeof name - 1; n += 3)
            memcpy(name + n, "事", 3);
        name[n] = '\0';
        err.code = 0;
        rad_fail(&err, RAD_EDATA, "%s", name);
        rad_error_format(&err, buf, sizeof buf);
        /* at each side of the gap a character of three bytes is left out */
        ck_assert_uint_ge(strlen(buf), sizeof err.what - 1 - 2 * 2);
        ck_assert_ptr_null(strchr(buf, '?'));
    }
}

TEST(message_says_nothing_that_a_terminal_obeys)
{
    struct rad_error err = { 0 };
    char buf[100], small[8];

    rad_error_where(&err, "%s", "\xe2\x80\xae.rad");
    rad_fail(&err, RAD_EDATA,
             "no '\xc2\x9b"
             "2J'");
    rad_error_format(&err, buf, sizeof buf);
    ck_assert_str_eq(buf, "?.rad: no '?2J'");
    rad_error_format(&err, small, sizeof small);
    ck_assert_str_eq(small, "?.rad");
}
