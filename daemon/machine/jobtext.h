/* jobtext.h - the texts of a job's specification, read back
 *
 * A job travels with its options and views as texts that rpict(1) would take;
 * these functions make structs of them.
 * Thread: any. */
#ifndef RADD_DAEMON_JOBTEXT_H
#define RADD_DAEMON_JOBTEXT_H

#include "image/filter.h"
#include "base/params.h"
#include "picture/view.h"

/* Parse a text of rad_params_format().  RAD_EDATA: it is none. */
int jobtext_params(const char *text, struct rad_params *p,
                   struct rad_error *err);

/* Parse a text of rad_view_format(), and set up the view.  RAD_EDATA: it is
 * none. */
int jobtext_view(const char *text, struct rad_view *v, struct rad_error *err);

/* Write the options for the header of a job's picture (rad_filter_options()),
 * from `params` of its message.  RAD_EDATA: these are no options. */
int jobtext_options(const char *params, int oversample, double clamp,
                    char text[RAD_FILTER_OPTIONS], struct rad_error *err);

/* Set *aspect to the height / width of a pixel in a picture of that size.
 * RAD_EDATA: params or view is no such text. */
int jobtext_pixaspect(const char *params, const char *view, int width,
                      int height, double *aspect, struct rad_error *err);

#endif
