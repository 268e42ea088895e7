/* submit_parse.h - radsubmit's command line, word by word
 *
 * Words with one dash are rpict's (src/base/params.h and view.h, and those
 * that name files); words with two are ours, "--name=value" or "--name value".
 * They may stand in any order before the first scene file; "--" ends them.
 * Everything that can be said wrong about a command line alone is said here,
 * before any file but option and view files is opened.  */
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

/* Defaults, then the words of w, which must outlive *o.  Returns an enum
 * submit_wish; a negative code and a message for what is wrong. */
int submit_parse(struct submit_options *o, struct words *w,
                 struct rad_error *err);

#endif
