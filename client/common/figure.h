/* figure.h - a number in plain digits
 *
 * Thread: any. */
#ifndef RADD_CLIENT_FIGURE_H
#define RADD_CLIENT_FIGURE_H

#define FIGURE_TEXT 32

/* Format x, at least 0, with that many significant digits, without exponent and
 * with at most six decimals: "0.83", "1.8", "180".  Returns text. */
const char *figure(char text[FIGURE_TEXT], double x, int digits);

#endif
