/* figure.h - a number as people say it
 *
 * Thread: any. */
#ifndef RADD_CLIENT_FIGURE_H
#define RADD_CLIENT_FIGURE_H

#define FIGURE_TEXT 32

/* So many digits of x that count, from 0 up, without exponent or what follows
 * the sixth place: "0.83", "1.8", "180".  Returns text. */
const char *figure(char text[FIGURE_TEXT], double x, int digits);

#endif
