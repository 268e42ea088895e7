/* quality.h - --quality: rendering options by one word
 *
 * One table (quality.c) gives the words their options.  What the command line
 * says itself counts, wherever it says it.  */
#ifndef RADD_CLIENT_QUALITY_H
#define RADD_CLIENT_QUALITY_H

#include "base/error.h"
#include "picture/params.h"

#include <stdint.h>

/* The words in their order, "|" between. */
#define QUALITY_WORDS "draft|low|medium|high|reference"

/* What the command line said itself: a bit for each row of the table. */
typedef uint32_t quality_given;

/* The bit of a rendering option ("-aa"), 0 if no quality sets it. */
quality_given quality_bit(const char *option);

/* Set what word number `quality` stands for and *given has not. */
int quality_apply(int quality, quality_given given, struct rad_params *p,
                  struct rad_error *err);

#endif
