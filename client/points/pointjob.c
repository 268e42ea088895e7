/* pointjob.c - see pointjob.h */
#include "config.h"

#include "points/pointjob.h"

#include "points/points.h"
#include "scene/file/bundle.h"

#include <stdlib.h>
#include <string.h>

int
pointjob_lay(struct pointjob *j, struct rad_error *err)
{
    j->pixel = malloc(j->in.n * sizeof *j->pixel);
    if (!j->pixel)
        return rad_fail_memory(err);
    return rad_points_lay((const double(*)[6])j->in.point, j->in.n, &j->width,
                          &j->height, j->pixel, err);
}

int
pointjob_read(struct pointjob *j, const struct pointspec *spec,
              struct rad_error *err)
{
    int rc;

    j->spec = spec;
    pointfile_init(&j->in, spec->file, spec->in, pointspec_most(spec));
    rc = pointfile_read(&j->in, err);
    return rc < 0 ? rc : pointjob_lay(j, err);
}

bool
pointjob_is_short(const struct pointjob *j)
{
    uint64_t most = pointspec_most(j->spec);

    return most < UINT64_MAX && j->first + j->in.n < most;
}

uint64_t
pointjob_number(const struct pointjob *j, uint32_t x, uint32_t y)
{
    for (uint32_t i = 0; i < j->in.n; i++)
        if (j->pixel[i] == y * (uint32_t)j->width + x)
            return j->first + i + 1;
    return 0;
}

int
pointjob_pack(const struct pointjob *j, struct rad_points *points,
              uint8_t **file, struct rad_error *err)
{
    uint32_t flags = (j->spec->irradiance ? RAD_POINTS_IRRADIANCE : 0) |
                     (j->spec->limited ? RAD_POINTS_LIMITED : 0);
    int rc;

    *file = rad_points_pack((const double(*)[6])j->in.point, j->in.n, j->first,
                            flags, j->width, j->height, j->pixel);
    if (!*file)
        return rad_fail_memory(err);
    rc = rad_points_open(points, *file, rad_points_bytes(j->width, j->height),
                         err);
    if (rc < 0) {
        free(*file);
        *file = NULL;
    }
    return rc;
}

int
pointjob_add(const struct pointjob *j, struct compiled *scene,
             const char *folder, struct rad_error *err)
{
    struct rad_points points;
    uint8_t *file;
    int rc = pointjob_pack(j, &points, &file, err);

    if (rc < 0)
        return rc;
    rc = compile_add(scene, RAD_BUNDLE_POINTS, file,
                     rad_points_bytes(j->width, j->height), folder, err);
    free(file);
    return rc;
}

void
pointjob_release(struct pointjob *j)
{
    pointfile_release(&j->in);
    free(j->pixel);
    memset(j, 0, sizeof *j);
}
