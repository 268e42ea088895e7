/* jobtext.h - the texts of a job's specification, read back
 *
 * A job travels with its options and views as rpict(1) would take them; these
 * make the structs again.
 * Thread: any. */
#ifndef RADD_DAEMON_JOBTEXT_H
#define RADD_DAEMON_JOBTEXT_H

#include "image/filter.h"
#include "base/params.h"
#include "picture/view.h"

/* rad_params_format()'s text; RAD_EDATA for anything else. */
int jobtext_params(const char *text, struct rad_params *p,
                   struct rad_error *err);

/* rad_view_format()'s text, set up; RAD_EDATA. */
int jobtext_view(const char *text, struct rad_view *v, struct rad_error *err);

/* The options of a job as its picture's header has them (rad_filter_options()),
 * from those of its message; RAD_EDATA. */
int jobtext_options(const char *params, int oversample, double clamp,
                    char text[RAD_FILTER_OPTIONS], struct rad_error *err);

/* Height / width of a pixel in a picture of that size. */
int jobtext_pixaspect(const char *params, const char *view, int width,
                      int height, double *aspect, struct rad_error *err);

#endif
