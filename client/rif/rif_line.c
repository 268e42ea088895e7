/* rif_line.c - see rif_line.h */
#include "config.h"

#include "rif/rif_line.h"

#include "base/number.h"
#include "base/params.h"

#include <stdio.h>
#include <string.h>

int
rif_line_add(struct rif_line *l, const char *word)
{
    if (l->n + 1 >= l->room) {
        int room = l->room ? 2 * l->room : 64;
        char **list =
            rad_arena_calloc(&l->rif->arena, (size_t)room, sizeof *list);

        if (!list)
            return rad_fail_memory(l->err);
        if (l->n > 0)
            memcpy(list, l->list, (size_t)l->n * sizeof *list);
        l->list = list;
        l->room = room;
    }
    if (!word)
        return rad_fail_memory(l->err);
    l->list[l->n++] = (char *)word; /* words are only read */
    return 0;
}

int
rif_line_words(struct rif_line *l, char *const *words, int n)
{
    int rc = n < 0 ? n : 0;

    for (int i = 0; i < n && rc == 0; i++)
        rc = rif_line_add(l, words[i]);
    return rc;
}

static int
add_text(struct rif_line *l, const char *text)
{
    char **words;
    int n = rif_split(l->rif, text, &words, l->err);

    return rif_line_words(l, words, n);
}

static int
add_pair(struct rif_line *l, const char *option, const char *value)
{
    int rc = rif_line_add(l, option);

    return rc < 0 ? rc : rif_line_add(l, value);
}

/* Append a variable's words, without the name of a program at the beginning. */
static int
add_variable(struct rif_line *l, enum rif_var v)
{
    char **words;
    int n = rif_words(l->rif, v, &words, l->err);

    if (n > 0 && words[0][0] != '-' && words[0][0] != '@' && v == RIF_RPICT)
        return rif_line_words(l, words + 1, n - 1);
    return rif_line_words(l, words, n);
}

static int
add_resolution(struct rif_line *l, int times)
{
    struct rif *r = l->rif;
    const char *text = rif_text(r, RIF_RESOLUTION);
    char option[100];
    double aspect = 1;
    int x, y, n = sscanf(text ? text : "512", "%d %d %lf", &x, &y, &aspect);
    char more[24] = "";

    if (n == 1)
        y = x;
    if (n == 3)
        snprintf(more, sizeof more, " -pa %.3f", aspect);
    if (n < 1 || x < 1 || y < 1 || x > RAD_MAX_RES / times ||
        y > RAD_MAX_RES / times || !(aspect >= 0 && aspect < 1e6))
        return rif_fail(r, RIF_RESOLUTION, l->err,
                        "expected columns, rows and a pixel's aspect");
    snprintf(option, sizeof option, "-x %d -y %d%s", times * x, times * y,
             more);
    return add_text(l, option);
}

/* REPORT: minutes, and a file for errors. */
static int
add_report(struct rif_line *l)
{
    struct rif *r = l->rif;
    const char *text = rif_text(r, RIF_REPORT);
    char seconds[32];
    double minutes;
    char **words;
    int n, rc;

    if (!text)
        return 0;
    n = rif_split(r, text, &words, l->err);
    if (n < 0)
        return n;
    if (n < 1 || n > 2 || !rad_parse_real(words[0], &minutes) ||
        !(minutes >= 0 && minutes <= 1e6))
        return rif_fail(r, RIF_REPORT, l->err,
                        "expected minutes, and perhaps a file");
    snprintf(seconds, sizeof seconds, "-t %d", (int)(60 * minutes));
    rc = add_text(l, seconds);
    if (rc == 0 && n == 2)
        rc = add_pair(l, "-e", words[1]);
    return rc;
}

static int
note_options(struct rif_line *l, int first)
{
    size_t room = 1, at = 0;
    char *text;

    for (int i = first; i < l->n; i++)
        room += strlen(l->list[i]) + 1;
    text = rad_arena_alloc(&l->rif->arena, room);
    if (!text)
        return rad_fail_memory(l->err);
    for (int i = first; i < l->n; i++) {
        const char *w = l->list[i];
        bool option = w[0] == '@' || (w[0] == '-' && w[1] >= 'A');

        at += (size_t)snprintf(text + at, room - at, "%s%s",
                               i == first ? ""
                               : option   ? "\n"
                                          : " ",
                               w);
    }
    snprintf(text + at, room - at, "\n");
    l->optfile = text;
    return 0;
}

static int
add_rendering(struct rif_line *l, const struct rif_zone *z, bool rules)
{
    char light[RIF_RULES_TEXT], sampling[RIF_RULES_TEXT];
    const char *ambient = rif_text(l->rif, RIF_AMBFILE);
    int first = l->n, rc = rif_rules(l->rif, z, light, sampling, l->err);

    if (rc == 0 && rules)
        rc = add_text(l, light);
    if (rc == 0 && ambient)
        rc = add_pair(l, "-af", ambient);
    if (rc == 0)
        rc = add_variable(l, RIF_RENDER);
    if (rc == 0)
        rc = note_options(l, first);
    if (rc == 0 && rules)
        rc = add_text(l, sampling);
    return rc < 0 ? rc : add_variable(l, RIF_RPICT);
}

int
rif_line_options(struct rif_line *l, const struct rif_zone *z, bool rules,
                 bool raw)
{
    int times = rif_oversample(l->rif), rc = add_resolution(l, raw ? times : 1);
    char filter[32];

    snprintf(filter, sizeof filter, "--oversample=%d", raw ? 1 : times);
    if (rc == 0 && rules)
        rc = add_text(l, filter);
    if (rc == 0)
        rc = add_rendering(l, z, rules);
    return rc < 0 ? rc : add_report(l);
}

/* A pattern for file names from rad's name, whose "%" stand for themselves. */
static char *
pattern(struct rif_line *l, const char *root, const char *suffix)
{
    char *text = rad_arena_alloc(&l->rif->arena, 2 * strlen(root) + 16);
    char *to = text;

    if (!text)
        return NULL;
    for (; *root; root++) {
        *to++ = *root;
        if (*root == '%')
            *to++ = '%';
    }
    strcpy(to, suffix);
    return text;
}

int
rif_line_outputs(struct rif_line *l, const char *root, enum picfile_format as)
{
    const char *suffix = as == PICFILE_PNG ? "_%s.png" : "_%s.hdr";
    const char *picture = rif_text(l->rif, RIF_PICTURE);
    const char *depth = rif_text(l->rif, RIF_ZFILE);
    int rc = add_pair(l, "-o", pattern(l, picture ? picture : root, suffix));

    if (rc == 0 && depth)
        rc = add_pair(l, "-z", pattern(l, depth, "_%s.zbf"));
    return rc;
}
