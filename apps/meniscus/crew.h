/* crew.h: threads that work on items as they come and hand them back in the same order. */
#ifndef MENISCUS_CREW_H
#define MENISCUS_CREW_H

#include <stdbool.h>
#include <stddef.h>

struct crew; /* opaque; driven by one thread, the one that started it */

/* work(context, item) is called once for each item, in any of the threads; several items at once where there are several threads.
 * capacity: items that are in hand at most. NULL: out of memory. Where no thread can be had, crew_put works itself. */
struct crew *crew_start(int threads, size_t capacity, void (*work)(void *context, void *item), void *context);

/* Items put and not taken yet. */
size_t crew_count(const struct crew *crew);

/* Hands an item over; fewer than capacity must be in hand. */
void crew_put(struct crew *crew, void *item);

/* The item that was put longest ago, once it is done. NULL: none is in hand, or, where wait is false, it is still worked on. */
void *crew_take(struct crew *crew, bool wait);

/* Waits until all items in hand are done (whoever wants them takes them before), and frees. NULL is fine. */
void crew_stop(struct crew *crew);

#endif
