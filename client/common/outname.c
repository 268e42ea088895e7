/* outname.c - see outname.h */
#include "config.h"

#include "common/outname.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool
outname_suffix(const char *path, const char *suffix)
{
    size_t n = strlen(path), k = strlen(suffix);

    return n > k && strcasecmp(path + n - k, suffix) == 0;
}

/* Length and width of a "%d" or "%03d" at s; length 0: something else stands
 * there. */
static size_t
conversion(const char *s, int *width)
{
    char *end;
    long w = strtol(s + 1, &end, 10);

    if ((s[1] != 'd' && (s[1] < '0' || s[1] > '9')) || *end != 'd' || w > 20)
        return 0;
    *width = s[1] == 'd' ? 0 : (int)w;
    return (size_t)(end + 1 - s);
}

int
outname_frame(char **name, const char *pattern, int frame, bool need,
              struct rad_error *err)
{
    size_t size = strlen(pattern) + 32, used = 0, k;
    char *buf = malloc(size);
    int width, found = 0;

    if (!buf)
        return rad_fail_memory(err);
    for (const char *s = pattern; *s;) {
        if (*s != '%') {
            buf[used++] = *s++;
        } else if (s[1] == '%') {
            buf[used++] = '%';
            s += 2;
        } else if ((k = conversion(s, &width)) > 0 && found++ == 0) {
            used +=
                (size_t)snprintf(buf + used, size - used,
                                 s[1] == '0' ? "%0*d" : "%*d", width, frame);
            s += k;
        } else {
            free(buf);
            return rad_fail(err, RAD_EUSAGE,
                            "'%s': expected one %%d, as in '%%03d'", pattern);
        }
    }
    buf[used] = '\0';
    if (need && !found) {
        free(buf);
        return rad_fail(err, RAD_EUSAGE, "'%s': no %%d for the frame's number",
                        pattern);
    }
    *name = buf;
    return 0;
}

int
outname_view(char **name, const char *pattern, const char *view, bool need,
             struct rad_error *err)
{
    size_t len = strlen(view), used = 0;
    char *buf = malloc(strlen(pattern) + len + 1);
    int found = 0;

    if (!buf)
        return rad_fail_memory(err);
    for (const char *s = pattern; *s; s++) {
        if (*s != '%') {
            buf[used++] = *s;
        } else if (*++s == '%') {
            buf[used++] = '%';
        } else if (*s == 's' && found++ == 0) {
            memcpy(buf + used, view, len);
            used += len;
        } else {
            free(buf);
            return rad_fail(err, RAD_EUSAGE,
                            "'%s': expected one %%s, for the view's name",
                            pattern);
        }
    }
    buf[used] = '\0';
    if (need && !found) {
        free(buf);
        return rad_fail(err, RAD_EUSAGE, "'%s': no %%s for the view's name",
                        pattern);
    }
    *name = buf;
    return 0;
}
