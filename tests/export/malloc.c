/* A shim that says so where the thread that sleeps until absolute times, which is the loop, allocates memory. */
#define _GNU_SOURCE
#include <errno.h>
#include <stddef.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

static long loop_thread;

static void look(void)
{
    static const char text[] = "the loop allocates\n";
    if (loop_thread && syscall(SYS_gettid) == loop_thread) (void)!write(2, text, sizeof text - 1);
}

void *malloc(size_t size)
{
    look();
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    look();
    return __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    look();
    return __libc_realloc(memory, size);
}

int clock_nanosleep(clockid_t clock, int flags, const struct timespec *due, struct timespec *left)
{
    if (flags) loop_thread = syscall(SYS_gettid);
    return syscall(SYS_clock_nanosleep, clock, flags, due, left) == 0 ? 0 : errno;
}
