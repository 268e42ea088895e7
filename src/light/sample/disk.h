/* disk.h - a map between the unit square [0, 1]^2 and the unit disk
 *
 * The map keeps relative areas and is continuous both ways.
 * Source: Shirley & Chiu 1997. */
#ifndef RAD_LIGHT_DISK_H
#define RAD_LIGHT_DISK_H

/* Map (x, y) in the square to d in the disk. */
void rad_disk_of_square(double x, double y, double d[2]);

/* Map (x, y) in the disk to s in the square. */
void rad_square_of_disk(double x, double y, double s[2]);

#endif
