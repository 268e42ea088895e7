/* words.c - see words.h */
#include "config.h"

#include "common/words.h"

#include "base/text.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    LONGEST_FILE = 1 << 20, /* most bytes of an @file */
    MOST_WORDS = 1 << 16,
    MOST_EXPANSIONS = 1000 /* a file that names itself ends here */
};

/* Make room for n words and a NULL. */
static int
reserve(struct words *w, int n, struct rad_error *err)
{
    char **list;
    int room = w->room ? w->room : 64;

    if (n > MOST_WORDS)
        return rad_fail(err, RAD_EUSAGE, "more than %d words", MOST_WORDS);
    while (room < n + 1)
        room *= 2;
    if (room == w->room)
        return 0;
    list = rad_arena_alloc(&w->arena, (size_t)room * sizeof *list);
    if (!list)
        return rad_fail_memory(err);
    if (w->n > 0)
        memcpy(list, w->list, (size_t)w->n * sizeof *list);
    list[w->n] = NULL;
    w->list = list;
    w->room = room;
    return 0;
}

int
words_init(struct words *w, int argc, char *const argv[], struct rad_error *err)
{
    int rc;

    memset(w, 0, sizeof *w);
    rad_arena_init(&w->arena);
    rc = reserve(w, argc > 1 ? argc - 1 : 0, err);
    if (rc < 0)
        return rc;
    for (int i = 1; i < argc; i++)
        w->list[w->n++] = argv[i];
    w->list[w->n] = NULL;
    return 0;
}

void
words_release(struct words *w)
{
    inputs_release(&w->inputs);
    rad_arena_release(&w->arena);
    memset(w, 0, sizeof *w);
}

static int
count_words(const char *s)
{
    int n = 0;

    for (;;) {
        while (isspace((unsigned char)*s))
            s++;
        if (*s == '\0')
            return n;
        n++;
        while (*s && !isspace((unsigned char)*s))
            s++;
    }
}

/* Replace the word at `at` by the words of text, which is cut up. */
static int
replace(struct words *w, int at, char *text, struct rad_error *err)
{
    int k = count_words(text), rc = reserve(w, w->n - 1 + k, err);
    char *save, *word = text;

    if (rc < 0)
        return rc;
    memmove(w->list + at + k, w->list + at + 1,
            (size_t)(w->n - at) * sizeof *w->list);
    w->n += k - 1;
    for (int i = 0; i < k; i++) {
        w->list[at + i] = strtok_r(word, " \t\n\v\f\r", &save);
        word = NULL;
    }
    return 0;
}

/* Make comments blank: a '#' that begins a word, to the end of its line. */
static void
blank_comments(char *s)
{
    bool apart = true; /* a word may begin here */

    for (; *s; s++) {
        if (*s == '#' && apart) {
            size_t n = strcspn(s, "\n");

            memset(s, ' ', n);
            s += n;
            if (*s == '\0')
                return;
        }
        apart = isspace((unsigned char)*s);
    }
}

static int
read_text(struct words *w, const char *path, char **text, struct rad_error *err)
{
    FILE *f = fopen(path, "r");
    size_t n, mark;
    char *buf;
    int rc = 0;

    if (!f)
        return rad_fail(err, RAD_ENOINPUT, "cannot open options file '%s': %s",
                        path, strerror(errno));
    buf = malloc(LONGEST_FILE + 1);
    if (!buf) {
        fclose(f);
        return rad_fail_memory(err);
    }
    n = fread(buf, 1, LONGEST_FILE + 1, f);
    mark = rad_text_mark(buf, n);
    if (ferror(f))
        rc = rad_fail(err, RAD_ENOINPUT, "cannot read options file '%s': %s",
                      path, strerror(errno));
    else if (n > LONGEST_FILE || memchr(buf, '\0', n))
        rc = rad_fail(err, RAD_EUSAGE, "'%s' is not an options file", path);
    else if (!(*text = rad_arena_strndup(&w->arena, buf + mark, n - mark)))
        rc = rad_fail_memory(err);
    else
        rc = inputs_add_fd(&w->inputs, "a file of options", fileno(f), err);
    if (rc == 0)
        blank_comments(*text);
    free(buf);
    fclose(f);
    return rc;
}

static int
read_variable(struct words *w, const char *name, char **text,
              struct rad_error *err)
{
    const char *value = getenv(name);

    if (!value)
        return rad_fail(err, RAD_EUSAGE, "variable '%s' is not set", name);
    *text = rad_arena_strndup(&w->arena, value, strlen(value));
    return *text ? 0 : rad_fail_memory(err);
}

int
words_expand(struct words *w, int at, struct rad_error *err)
{
    while (at < w->n && (w->list[at][0] == '@' || w->list[at][0] == '$')) {
        const char *word = w->list[at];
        char *text = NULL;
        int rc;

        if (++w->expanded > MOST_EXPANSIONS)
            return rad_fail(err, RAD_EUSAGE,
                            "'%s': more than %d words to expand", word,
                            MOST_EXPANSIONS);
        if (word[0] == '@')
            rc = read_text(w, word + 1, &text, err);
        else
            rc = read_variable(w, word + 1, &text, err);
        if (rc == 0)
            rc = replace(w, at, text, err);
        if (rc < 0)
            return rc;
    }
    return 0;
}

int
words_place(const char *words, const char *word)
{
    size_t len = strlen(word);

    for (int i = 0; words; i++) {
        size_t n = strcspn(words, "|");

        if (n == len && strncmp(words, word, n) == 0)
            return i;
        words = words[n] ? words + n + 1 : NULL;
    }
    return -1;
}
