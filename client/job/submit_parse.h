/* submit_parse.h - radsubmit's command line, word by word
 *
 * Words with one dash are rpict's (src/base/params.h and view.h, and options
 * that name files); words with two dashes are our own, "--name=value" or
 * "--name value".  They may stand in any order before the first scene file;
 * "--" ends them.  All errors that can be seen in the command line alone are
 * reported here, before any file but files of options and views is opened. */
#ifndef RADD_CLIENT_SUBMIT_PARSE_H
#define RADD_CLIENT_SUBMIT_PARSE_H

#include "common/words.h"
#include "job/submit_options.h"
#include "base/error.h"

enum submit_wish {
    SUBMIT_RUN,
    SUBMIT_HELP,
    SUBMIT_VERSION,
    SUBMIT_DEFAULTS,
    SUBMIT_RPICT /* --rpict-path */
};

/* Set the defaults, then take the words of w, which must outlive *o.  Returns
 * an enum submit_wish; or a negative code and a message. */
int submit_parse(struct submit_options *o, struct words *w,
                 struct rad_error *err);

#endif
