/* markup.c - see markup.h */
#include "config.h"

#include "observer/markup.h"

#include "base/number.h"
#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST ((size_t)64 << 20) /* bytes of any text */

static bool
make_room(struct markup *m, size_t n)
{
    size_t cap = m->cap;
    char *p;

    if (m->failed || n > MOST - m->len - 1) {
        m->failed = true;
        return false;
    }
    if (cap > m->len + n)
        return true;
    cap = 2 * (m->len + n) + 256;
    p = realloc(m->text, cap);
    if (!p) {
        m->failed = true;
        return false;
    }
    m->text = p;
    m->cap = cap;
    return true;
}

void
markup_bytes(struct markup *m, const char *s, size_t n)
{
    if (!make_room(m, n))
        return;
    memcpy(m->text + m->len, s, n);
    m->len += n;
    m->text[m->len] = '\0';
}

void
markup_raw(struct markup *m, const char *s)
{
    markup_bytes(m, s, strlen(s));
}

void
markup_print(struct markup *m, const char *fmt, ...)
{
    char buf[512];
    va_list ap;
    int n;

    va_start(ap, fmt);
    n = vsnprintf(buf, sizeof buf, fmt, ap);
    va_end(ap);
    if (n < 0 || (size_t)n >= sizeof buf)
        m->failed = true; /* our bug: formats are for numbers */
    else
        markup_bytes(m, buf, (size_t)n);
}

/* A copy without characters that hide or turn around what is beside them. */
static char *
clean_copy(struct markup *m, const char *s)
{
    char *copy = strdup(s ? s : "");

    if (copy)
        rad_text_clean(copy);
    else
        m->failed = true;
    return copy;
}

/* The text, with other words for some characters. */
static void
put_escaped(struct markup *m, const char *s, const char *(*word)(char c))
{
    char *copy = clean_copy(m, s);

    for (const char *p = copy; p && *p; p++) {
        const char *w = word(*p);

        if (w)
            markup_raw(m, w);
        else
            markup_bytes(m, p, 1);
    }
    free(copy);
}

static const char *
html_word(char c)
{
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    case '\'':
        return "&#39;";
    default:
        return NULL;
    }
}

void
markup_text(struct markup *m, const char *s)
{
    put_escaped(m, s, html_word);
}

void
markup_json(struct markup *m, const json_t *value)
{
    char *s = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT |
                                    JSON_REAL_PRECISION(9));

    if (s)
        markup_raw(m, s);
    else
        m->failed = true;
    free(s);
}

void
markup_count(struct markup *m, double v)
{
    char text[RAD_NUMBER_TEXT];

    rad_format_brief(text, v >= 0 && v <= 1e18 ? v : 0);
    markup_raw(m, text);
}

void
markup_size(struct markup *m, double v)
{
    markup_count(m, v);
    markup_raw(m, v >= 999.5 ? "B" : " B");
}

void
markup_span(struct markup *m, double s)
{
    double min = floor(s / 60), h = floor(s / 3600);

    if (!(s >= 0) || s > 1e12)
        markup_raw(m, "-");
    else if (s > 0 && s < .0995)
        markup_print(m, "%.*f ms", s < .00095 ? 2 : 0, 1000 * s);
    else if (s < 60)
        markup_print(m, s < 9.95 && s > 0 ? "%.1f s" : "%.0f s", s);
    else if (h < 1)
        markup_print(m, "%.0f min %.0f s", min, floor(s - 60 * min));
    else if (h < 48)
        markup_print(m, "%.0f h %.0f min", h, min - 60 * h);
    else
        markup_print(m, "%.0f days %.0f h", floor(h / 24), fmod(h, 24));
}

const char *
markup_member(const json_t *row, const char *key)
{
    const char *s = json_string_value(json_object_get(row, key));

    return s ? s : "";
}

double
markup_number(const json_t *row, const char *key)
{
    double v = json_number_value(json_object_get(row, key));

    return isfinite(v) ? v : 0;
}

char *
markup_take(struct markup *m, size_t *len)
{
    char *text = m->text;

    if (m->failed || (!text && !(text = strdup("")))) {
        markup_release(m);
        return NULL;
    }
    if (len)
        *len = m->len;
    *m = (struct markup){ 0 };
    return text;
}

void
markup_release(struct markup *m)
{
    free(m->text);
    *m = (struct markup){ 0 };
}
