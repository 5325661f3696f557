/* A lock-free ring of one writer and one reader. Its elements stand beside it, in an array of `size`; element n is
 * in place n % size. The atomic accesses are those of gcc and clang, which C99 has no name for. */
#ifndef RING_H
#define RING_H

#include <stdint.h>

typedef struct {
    uint64_t head, tail; /* elements written, by the writer alone, and read, by the reader alone */
} ring_t;

/* The writer's next place, -1 while the ring is full; it fills the place and then publishes it. */
static inline int64_t ring_place(const ring_t *ring, uint64_t size)
{
    const uint64_t head = __atomic_load_n(&ring->head, __ATOMIC_RELAXED);
    return head - __atomic_load_n(&ring->tail, __ATOMIC_ACQUIRE) < size ? (int64_t)(head % size) : -1;
}

static inline void ring_publish(ring_t *ring)
{
    __atomic_store_n(&ring->head, __atomic_load_n(&ring->head, __ATOMIC_RELAXED) + 1u, __ATOMIC_RELEASE);
}

/* The place of the reader's next element, -1 while the ring is empty; it reads the element and then releases it. */
static inline int64_t ring_next(const ring_t *ring, uint64_t size)
{
    const uint64_t tail = __atomic_load_n(&ring->tail, __ATOMIC_RELAXED);
    return tail != __atomic_load_n(&ring->head, __ATOMIC_ACQUIRE) ? (int64_t)(tail % size) : -1;
}

static inline void ring_release(ring_t *ring)
{
    __atomic_store_n(&ring->tail, __atomic_load_n(&ring->tail, __ATOMIC_RELAXED) + 1u, __ATOMIC_RELEASE);
}

#endif
