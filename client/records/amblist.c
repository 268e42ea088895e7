/* amblist.c - see amblist.h */
#include "config.h"

#include "records/amblist.h"
#include "compile/paths.h"

#include <stdlib.h>
#include <string.h>

enum { LONGEST = 1 << 20 /* most bytes of such a file */ };

/* Take the names in text, which is cut up. */
static int
take_names(struct rad_params *p, char *option, char *text,
           struct rad_error *err)
{
    char *argv[3] = { option }, *save;
    int rc = 1;

    for (char *name = strtok_r(text, " \t\n\v\f\r", &save); name && rc > 0;
         name = strtok_r(NULL, " \t\n\v\f\r", &save)) {
        argv[1] = name;
        rc = rad_params_option(p, 2, argv, err);
    }
    return rc < 0 ? rc : 0;
}

static int
take_file(struct rad_params *p, char *option, const char *name,
          struct rad_error *err)
{
    struct paths paths;
    unsigned char *text = NULL;
    char *path, *copy;
    size_t len;
    int rc = paths_init(&paths, err);

    if (rc < 0)
        return rc;
    path = paths_find(&paths, name, err);
    if (path)
        text = rad_file_read(path, LONGEST, &len, err);
    if (!text) {
        rc = err->code;
    } else if (!(copy = strndup((const char *)text, len))) {
        rc = rad_fail_memory(err);
    } else {
        rc = take_names(p, option, copy, err);
        free(copy);
        if (rc < 0)
            rad_error_where(err, "%s", name);
    }
    free(text);
    free(path);
    paths_release(&paths);
    return rc;
}

int
amblist_option(struct rad_params *p, int argc, char *const argv[],
               struct rad_error *err)
{
    char option[] = "-ae";
    int rc;

    if (strcmp(argv[0], "-aE") != 0 && strcmp(argv[0], "-aI") != 0)
        return 0;
    if (argc < 2)
        return rad_fail(err, RAD_EUSAGE, "option '%s': missing value", argv[0]);
    option[2] = argv[0][2] == 'E' ? 'e' : 'i';
    rc = take_file(p, option, argv[1], err);
    return rc < 0 ? rc : 2;
}
