/* inputs.c - see inputs.h */
#include "config.h"

#include "common/inputs.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

static const struct input *
find(const struct inputs *in, const struct stat *st)
{
    for (size_t i = 0; i < in->n; i++)
        if (in->list[i].dev == st->st_dev && in->list[i].ino == st->st_ino)
            return &in->list[i];
    return NULL;
}

static int
add(struct inputs *in, const char *what, const struct stat *st,
    struct rad_error *err)
{
    if (!in || !S_ISREG(st->st_mode) || find(in, st))
        return 0;
    if (!rad_list_grow(&in->list, in->n, sizeof *in->list))
        return rad_fail_memory(err);
    in->list[in->n++] = (struct input){ st->st_dev, st->st_ino, what };
    return 0;
}

int
inputs_add(struct inputs *in, const char *what, const char *path,
           struct rad_error *err)
{
    struct stat st;

    return path && stat(path, &st) == 0 ? add(in, what, &st, err) : 0;
}

int
inputs_add_fd(struct inputs *in, const char *what, int fd,
              struct rad_error *err)
{
    struct stat st;

    return fstat(fd, &st) == 0 ? add(in, what, &st, err) : 0;
}

const char *
inputs_find(const struct inputs *in, const char *path)
{
    const struct input *found;
    struct stat st;

    if (stat(path, &st) != 0)
        return NULL;
    found = find(in, &st);
    return found ? found->what : NULL;
}

void
inputs_release(struct inputs *in)
{
    free(in->list);
    memset(in, 0, sizeof *in);
}
