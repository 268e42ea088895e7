/* sources.h - the list of light sources, for the files of light/ */
#ifndef RAD_LIGHT_SOURCES_H
#define RAD_LIGHT_SOURCES_H

#include "light/sample.h"
#include "light/source.h"

struct rad_virtual;

struct rad_sources {
    struct rad_source *list;
    int32_t n;
    int32_t nlit;     /* that give direct light */
    int32_t *distant; /* indices of the distant ones, in scene order */
    int32_t ndistant;
    struct rad_virtual *virtuals; /* source i >= n is virtuals[i - n] */
    int32_t nvirtuals;
};

#endif
