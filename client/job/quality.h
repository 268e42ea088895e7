/* quality.h - --quality: rendering options by one word
 *
 * One table (quality.c) gives the words their options.  An option that the
 * command line has itself prevails, wherever it stands. */
#ifndef RADD_CLIENT_QUALITY_H
#define RADD_CLIENT_QUALITY_H

#include "base/error.h"
#include "base/params.h"

#include <stdbool.h>
#include <stdint.h>

/* The words in their order, "|" between. */
#define QUALITY_WORDS "draft|low|medium|high|reference"

/* The options that --error and --time begin with where the command line has
 * none. */
int quality_first(struct rad_params *p, struct rad_error *err);

/* What the command line said itself: a bit for each row of the table. */
typedef uint32_t quality_given;

/* The bit of a rendering option ("-aa"), 0 if no quality sets it. */
quality_given quality_bit(const char *option);

/* Samples a side of each pixel, for --oversample, that word number `quality`
 * stands for. */
int quality_oversample(int quality);

/* What a word delivers, as it was measured on six scenes (doc/accuracy.md): the
 * error of the luminance of areas of 5 by 5 pixels [%], of the best scene and
 * of the worst; false where that was not measured.  It holds of a set that the
 * command line leaves whole. */
bool quality_promise(int quality, double *least, double *most);

/* The word of that number, of *len characters, not terminated. */
const char *quality_word(int quality, int *len);

/* Set all options of word number `quality` but those that are in given. */
int quality_apply(int quality, quality_given given, struct rad_params *p,
                  struct rad_error *err);

#endif
