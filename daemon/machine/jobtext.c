/* jobtext.c - see jobtext.h */
#include "config.h"

#include "machine/jobtext.h"

#include <stdlib.h>
#include <string.h>

/* more words than rad_params_format() writes, with the names of -ae */
#define MAX_WORDS 1024

/* Part text at its blanks; the words lie in *copy, which the caller frees.
 * Returns their number or a negative code. */
static int
split(const char *text, char **copy, char *words[MAX_WORDS],
      struct rad_error *err)
{
    char *save, *w;
    int n = 0;

    *copy = strdup(text);
    if (!*copy)
        return rad_fail_memory(err);
    for (w = strtok_r(*copy, " ", &save); w; w = strtok_r(NULL, " ", &save)) {
        if (n == MAX_WORDS)
            return rad_fail(err, RAD_EDATA, "more than %d words of options",
                            MAX_WORDS);
        words[n++] = w;
    }
    return n;
}

/* Read rendering options into *p, or options of a view into *v; the other of p
 * and v is NULL. */
static int
read_options(const char *text, struct rad_params *p, struct rad_view *v,
             struct rad_error *err)
{
    char *copy, *words[MAX_WORDS];
    int n = split(text, &copy, words, err), rc = n < 0 ? n : 0;

    for (int i = 0; i < n && rc == 0;) {
        int used = p ? rad_params_option(p, n - i, words + i, err)
                     : rad_view_option(v, n - i, words + i, err);

        if (used == 0)
            rc = rad_fail(err, RAD_EDATA, "unknown option '%s'", words[i]);
        else if (used < 0)
            rc = used;
        else
            i += used;
    }
    free(copy);
    return rc == RAD_EUSAGE ? RAD_EDATA : rc;
}

int
jobtext_params(const char *text, struct rad_params *p, struct rad_error *err)
{
    int rc;

    rad_params_init(p);
    rc = read_options(text, p, NULL, err);
    if (rc == 0 && rad_params_check(p, err) < 0)
        rc = RAD_EDATA;
    return rc;
}

int
jobtext_view(const char *text, struct rad_view *v, struct rad_error *err)
{
    int rc;

    rad_view_init(v);
    rc = read_options(text, NULL, v, err);
    if (rc == 0 && rad_view_setup(v, err) < 0)
        rc = RAD_EDATA;
    return rc;
}

int
jobtext_options(const char *params, int oversample, double clamp,
                char text[RAD_FILTER_OPTIONS], struct rad_error *err)
{
    struct rad_params p;
    int rc = jobtext_params(params, &p, err);

    if (rc == 0)
        rad_filter_options(&p, oversample, clamp, text);
    return rc;
}

int
jobtext_pixaspect(const char *params, const char *view, int width, int height,
                  double *aspect, struct rad_error *err)
{
    struct rad_params p;
    struct rad_view v;
    int rc = jobtext_params(params, &p, err);

    if (rc == 0)
        rc = jobtext_view(view, &v, err);
    if (rc < 0)
        return rc;
    *aspect = p.pixaspect;
    if (*aspect <= 0)
        rad_view_resolution(&v, aspect, &width, &height);
    return 0;
}
