/* stored.c - see stored.h */
#include "config.h"

#include "pattern/stored.h"
#include "scene/file/data.h"
#include "scene/file/specpict.h"

#include <stdlib.h>
#include <string.h>

struct rad_stored {
    struct rad_stored *next;
    rad_stored_parse parse; /* NULL: a picture */
    const char *name;
    const void *what; /* made by parse */
};

static const void *
find(const struct rad_job *job, const char *name, rad_stored_parse parse)
{
    for (const struct rad_stored *s = job->stored; s; s = s->next)
        if (s->parse == parse && strcmp(s->name, name) == 0)
            return s->what;
    return NULL;
}

static const void *
load(struct rad_job *job, const struct rad_object *o,
     const struct rad_files *files, const char *name, rad_stored_parse parse,
     struct rad_error *err)
{
    struct rad_error why = { 0 };
    const void *what;
    char *bytes;
    size_t len;

    if (rad_material_file(job, o, files, name, &bytes, &len, err))
        return NULL;
    what = parse(&job->arena, bytes, len, &why);
    free(bytes);
    if (!what)
        rad_material_file_fail(job, o, name, &why, err);
    return what;
}

/* Note what was made of a file, for other objects; NULL stays NULL. */
static const void *
note(struct rad_job *job, const char *name, rad_stored_parse parse,
     const void *what, struct rad_error *err)
{
    struct rad_stored *s;

    if (!what)
        return NULL;
    s = rad_arena_calloc(&job->arena, 1, sizeof *s);
    if (s)
        s->name = rad_arena_strndup(&job->arena, name, strlen(name));
    if (!s || !s->name) {
        rad_fail_memory(err);
        return NULL;
    }
    s->parse = parse;
    s->what = what;
    s->next = job->stored;
    job->stored = s;
    return what;
}

const void *
rad_stored(struct rad_job *job, const struct rad_object *o,
           const struct rad_files *files, const char *name,
           rad_stored_parse parse, struct rad_error *err)
{
    const void *what = find(job, name, parse);

    return what ? what
                : note(job, name, parse, load(job, o, files, name, parse, err),
                       err);
}

static const void *
parse_data(struct rad_arena *arena, const char *bytes, size_t len,
           struct rad_error *err)
{
    return rad_data_parse(arena, bytes, len, err);
}

const struct rad_data *
rad_stored_data(struct rad_job *job, const struct rad_object *o,
                const struct rad_files *files, const char *name,
                struct rad_error *err)
{
    return rad_stored(job, o, files, name, parse_data, err);
}

/* A picture may be large, so it is decoded as it is read. */
static const struct rad_pict *
load_picture(struct rad_job *job, const struct rad_object *o,
             const struct rad_files *files, const char *name,
             struct rad_error *err)
{
    struct rad_error why = { 0 };
    const struct rad_pict *p = NULL;
    struct rad_opened file;

    if (files && rad_files_open(files, name, &file, &why) == 0) {
        p = rad_pict_parse(&job->arena, &file.in, !job->unseen, &why);
        rad_opened_close(&file);
    }
    if (!p) {
        rad_fail(&why, RAD_ENOINPUT, "no file '%s'", name);
        rad_material_file_fail(job, o, name, &why, err);
    }
    return p;
}

const struct rad_pict *
rad_stored_picture(struct rad_job *job, const struct rad_object *o,
                   const struct rad_files *files, const char *name,
                   struct rad_error *err)
{
    const void *what = find(job, name, NULL);

    return what ? what
                : note(job, name, NULL, load_picture(job, o, files, name, err),
                       err);
}

static const void *
parse_specpict(struct rad_arena *arena, const char *bytes, size_t len,
               struct rad_error *err)
{
    return rad_specpict_parse(arena, (const uint8_t *)bytes, len, err);
}

const struct rad_data *
rad_stored_specpict(struct rad_job *job, const struct rad_object *o,
                    const struct rad_files *files, const char *name,
                    struct rad_error *err)
{
    return rad_stored(job, o, files, name, parse_specpict, err);
}
