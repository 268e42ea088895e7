/* list.h - arrays that grow by one element at a time
 *
 * Thread: any; a list belongs to one thread at a time.  */
#ifndef RAD_BASE_LIST_H
#define RAD_BASE_LIST_H

#include <stdbool.h>
#include <stddef.h>

/* Make room for one more behind the n elements, of `size` bytes each, of an
 * array: *(T **)list, which is NULL at first, which this function alone
 * allocates, and whose caller frees it.  It is full whenever n is a power of
 * two, so nobody has to remember how large it is.  False: memory is out, and
 * the array is as it was. */
bool rad_list_grow(void *list, size_t n, size_t size);

#endif
