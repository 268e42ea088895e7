/* disk.h - the unit square and the unit disk, one mapped to the other
 *
 * Relative areas are kept, and neighbours stay neighbours.
 * Source: Shirley & Chiu 1997. */
#ifndef RAD_LIGHT_DISK_H
#define RAD_LIGHT_DISK_H

void rad_disk_of_square(double x, double y, double d[2]);

/* The reverse. */
void rad_square_of_disk(double x, double y, double s[2]);

#endif
