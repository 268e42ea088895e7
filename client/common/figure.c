/* figure.c - see figure.h */
#include "config.h"

#include "common/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *
figure(char text[FIGURE_TEXT], double x, int digits)
{
    enum { MOST_PLACES = 6 };
    int places = 0;

    if (x > 0 && x < 1e15) {
        int before = (int)floor(log10(x)) + 1; /* digits before the point */
        double unit = pow(10, before - digits);

        if (before > digits)
            x = round(x / unit) * unit;
        else
            places = digits - before;
    }
    if (places > MOST_PLACES)
        places = MOST_PLACES;
    snprintf(text, FIGURE_TEXT, x < 1e15 ? "%.*f" : "%.*g", places, x);
    if (strchr(text, '.')) {
        size_t n = strlen(text);

        while (text[n - 1] == '0')
            text[--n] = '\0';
        if (text[n - 1] == '.')
            text[--n] = '\0';
    }
    return text;
}
