/* otype.c - see otype.h */
#include "config.h"

#include "scene/otype.h"

#include <string.h>

static const struct {
    const char *name;
    enum rad_oclass class;
} types[RAD_NOTYPES] = {
#define OTYPE(symbol, name, class) { name, class },
#include "scene/otype.def"
#undef OTYPE
};

const char *
rad_otype_name(enum rad_otype t)
{
    return types[t].name;
}

enum rad_oclass
rad_otype_class(enum rad_otype t)
{
    return types[t].class;
}

int
rad_otype_find(const char *name)
{
    for (int t = 0; t < RAD_NOTYPES; t++)
        if (types[t].name[0] == name[0] && strcmp(types[t].name, name) == 0)
            return t;
    return -1;
}
