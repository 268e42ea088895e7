/* assets.h - files that are built into the program
 *
 * Pure; thread: any. */
#ifndef RADD_WEB_ASSETS_H
#define RADD_WEB_ASSETS_H

struct asset {
    const char *path; /* "/style.css" */
    const char *type; /* its media type */
    const char *bytes, *end;
};

/* The file at that path; NULL: there is none. */
const struct asset *assets_find(const char *path);

#endif
