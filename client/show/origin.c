/* origin.c - see origin.h */
#include "config.h"

#include "show/origin.h"

#include "common/outname.h"

#include "base/text.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* Most bytes of text for an octree's header and for names of scene files; the
 * stamp always finds room. */
#define OCTREE_BYTES 2048
#define SCENE_BYTES  1536

/* Lines of an octree's header that do not hold for a picture. */
static const char *const others[] = { "#?",        "FORMAT=",    "VIEW=",
                                      "EXPOSURE=", "PIXASPECT=", "COLORCORR=",
                                      "PRIMARIES=" };

/* Radiance's readers of headers take a view from command lines of these
 * programs, wherever they are installed; so such lines are left out. */
static const char *const viewers[] = { "rpict", "rview", "rvu", "rpiece",
                                       "pinterp" };

static bool
is_of_viewer(const char *line)
{
    const char *name = line, *end = line + strcspn(line, " \t");

    for (const char *p = line; p < end; p++)
        if (*p == '/' || *p == '\\')
            name = p + 1;
    for (size_t i = 0; i < sizeof viewers / sizeof viewers[0]; i++)
        if (strncmp(name, viewers[i], strlen(viewers[i])) == 0)
            return true;
    return false;
}

static bool
is_of_others(const char *line)
{
    if (is_of_viewer(line))
        return true;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (strncmp(line, others[i], strlen(others[i])) == 0)
            return true;
    return false;
}

/* Add a line, unless it is empty, if it fits into the first `room` bytes of the
 * text.  Does it fit? */
static bool
add_line(char *text, size_t room, const char *line)
{
    size_t used = strlen(text), n = strlen(line);

    if (n == 0)
        return true;
    if (used + n + 2 > room)
        return false;
    memcpy(text + used, line, n);
    memcpy(text + used + n, "\n", 2);
    rad_text_clean(text + used); /* takes the newline, too */
    text[used + n] = '\n';
    return true;
}

/* Open a scene file, if it is regular; a pipe must not be read again. */
static FILE *
open_file(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISREG(st.st_mode) ? fopen(path, "rb")
                                                       : NULL;
}

/* Add the header's lines of an octree; nothing, if the file is not one. */
static void
add_octree(char *text, const char *path)
{
    char line[OCTREE_BYTES];
    FILE *f = open_file(path);
    bool octree = f && fgets(line, sizeof line, f) &&
                  strncmp(line, "#?RADIANCE", 10) == 0;

    while (octree && fgets(line, sizeof line, f) && line[0] != '\n') {
        line[strcspn(line, "\r\n")] = '\0';
        if (!is_of_others(line) && !add_line(text, OCTREE_BYTES, line))
            break;
    }
    if (f)
        fclose(f);
}

/* Add "SCENE= a.rad b.rad", with as many names as fit. */
static void
add_scenes(char *text, const char *const *scenes, int n)
{
    char line[SCENE_BYTES] = "SCENE=";
    size_t used = strlen(line);

    for (int i = 0; i < n; i++) {
        const char *slash = strrchr(scenes[i], '/');
        const char *name = slash ? slash + 1 : scenes[i];

        if (used + strlen(name) + sizeof " ..." + 1 > sizeof line) {
            snprintf(line + used, sizeof line - used, " ...");
            break;
        }
        used += (size_t)snprintf(line + used, sizeof line - used, " %s", name);
    }
    add_line(text, MSG_MAX_ORIGIN, line);
}

static void
add_time(char *text, const char *format, const struct tm *tm)
{
    char line[64];

    if (tm && strftime(line, sizeof line, format, tm) > 0)
        add_line(text, MSG_MAX_ORIGIN, line);
}

static void
add_stamp(char *text, const struct origin_stamp *stamp)
{
    char line[300], hex[MSG_JOB_HEX];
    struct tm tm;

    add_time(text, "CAPDATE= %Y:%m:%d %H:%M:%S", localtime_r(&stamp->now, &tm));
    add_time(text, "GMT= %Y:%m:%d %H:%M:%S", gmtime_r(&stamp->now, &tm));
    snprintf(line, sizeof line, "HOST= %.255s", stamp->host);
    add_line(text, MSG_MAX_ORIGIN, line);
    msg_job_format(stamp->job, hex);
    snprintf(line, sizeof line, "JOB= %s", hex);
    add_line(text, MSG_MAX_ORIGIN, line);
}

void
origin_text(char text[MSG_MAX_ORIGIN + 1], const char *const *scenes, int n,
            const struct origin_stamp *stamp)
{
    text[0] = '\0';
    if (n == 1 && outname_suffix(scenes[0], ".oct"))
        add_octree(text, scenes[0]);
    add_scenes(text, scenes, n);
    if (stamp)
        add_stamp(text, stamp);
}
