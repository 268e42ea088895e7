/* option.c - see option.h */
#include "config.h"

#include "common/option.h"
#include "common/tell.h"
#include "common/words.h"

#include "base/help.h"
#include "base/number.h"

#include <string.h>

static int
out_of_range(const struct option *o, const char *text, struct rad_error *err)
{
    char lo[RAD_NUMBER_TEXT], hi[RAD_NUMBER_TEXT];

    rad_format_real(lo, o->lo);
    rad_format_real(hi, o->hi);
    return rad_fail(
        err, RAD_EUSAGE, "option '%s': '%.40s' is not a%s number from %s to %s",
        o->name, text, o->kind == OPTION_INT ? " whole" : "", lo, hi);
}

static int
take_word(int *field, const struct option *o, const char *text,
          struct rad_error *err)
{
    int i = words_place(o->words, text);

    if (i >= 0) {
        *field = i;
        return 0;
    }
    return rad_fail(err, RAD_EUSAGE, "option '%s': '%.40s' is none of %s",
                    o->name, text, o->words);
}

static int
take_value(void *field, const struct option *o, const char *text,
           struct rad_error *err)
{
    switch (o->kind) {
    case OPTION_FLAG:
        *(bool *)field = true;
        return 0;
    case OPTION_MAYBE:
        *(const char **)field = text;
        return 0;
    case OPTION_TEXT:
        if (text[0] == '\0')
            return rad_fail(err, RAD_EUSAGE, "option '%s': empty value",
                            o->name);
        *(const char **)field = text;
        return 0;
    case OPTION_INT:
        if (!rad_parse_int(text, field) || *(int *)field < o->lo ||
            *(int *)field > o->hi)
            return out_of_range(o, text, err);
        return 0;
    case OPTION_REAL:
        if (!rad_parse_real(text, field) || *(double *)field < o->lo ||
            *(double *)field > o->hi)
            return out_of_range(o, text, err);
        return 0;
    default:
        return take_word(field, o, text, err);
    }
}

/* Bytes of the option's name that the word is or begins with. */
static size_t
name_bytes(const char *word)
{
    return strncmp(word, "--", 2) == 0 ? strcspn(word, "=") : strlen(word);
}

const struct option *
option_find(const struct option *table, size_t n, const char *word)
{
    size_t len = name_bytes(word);

    for (size_t i = 0; i < n; i++)
        if (strlen(table[i].name) == len &&
            memcmp(table[i].name, word, len) == 0)
            return &table[i];
    return NULL;
}

int
option_take(const struct option *o, void *to, char *const argv[],
            struct rad_error *err)
{
    size_t len = name_bytes(argv[0]);
    const char *value = argv[0][len] ? argv[0] + len + 1 : NULL;
    int rc, used = 1;

    if (o->kind == OPTION_FLAG && value)
        return rad_fail(err, RAD_EUSAGE, "option '%s' takes no value", o->name);
    if (o->kind == OPTION_MAYBE && !value)
        value = "";
    if (o->kind != OPTION_FLAG && !value) {
        value = argv[1];
        used = 2;
        if (!value)
            return rad_fail(err, RAD_EUSAGE, "option '%s': missing value",
                            o->name);
    }
    rc = take_value((char *)to + o->field, o, value, err);
    return rc < 0 ? rc : used;
}

void
option_help(const struct option *table, size_t n, FILE *to)
{
    for (size_t i = 0; i < n; i++) {
        const struct option *o = &table[i];
        const char *between = o->name[1] == '-' ? "=" : " ";
        char head[80];

        snprintf(head, sizeof head, "%s%s%s", o->name,
                 o->arg && o->kind != OPTION_MAYBE ? between : "",
                 o->arg ? o->arg : "");
        rad_help_row(head, o->help, tell_line, to);
    }
}
