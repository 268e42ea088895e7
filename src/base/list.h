/* list.h - the length of an array; arrays that grow by one element at a time
 *
 * Thread: any; a list belongs to one thread at a time.  */
#ifndef RAD_BASE_LIST_H
#define RAD_BASE_LIST_H

#include <stdbool.h>
#include <stddef.h>

/* How many elements an array has; a constant. */
#define N_ELEM(a) ((int)(sizeof(a) / sizeof((a)[0])))

/* Make room for one more element in an array of n elements of `size` bytes.
 * list is the address of the pointer to the array, which is NULL at first.
 * Only this function allocates the array; the caller frees it.  An array is
 * full whenever n is a power of two, so its capacity need not be kept.  False:
 * memory is out, and the array is unchanged. */
bool rad_list_grow(void *list, size_t n, size_t size);

#endif
