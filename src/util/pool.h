/* pool.h: a fixed set of worker threads that run one job at a time. */
#ifndef MNS_UTIL_POOL_H
#define MNS_UTIL_POOL_H

#include <meniscus/common.h>

struct pool; /* opaque */

/* Processors this process may use (its affinity mask, where the system tells it; time quotas are not looked at), at least 1. */
int mns_processor_count(void);

/* threads - 1 workers: the caller is the last. NULL: out of memory or threads. */
struct pool *mns_pool_create(int threads, const struct mns_allocator *allocator);
void mns_pool_destroy(struct pool *pool); /* NULL is fine */

/* Calls job(context, i) for i in [0, count), each i once; returns when all are done. The calling thread takes its part. */
void mns_pool_run(struct pool *pool, void (*job)(void *context, int index), void *context, int count);

#endif
