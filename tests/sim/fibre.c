/* fibre.c - see fibre.h */
#include "config.h"

#include "fibre.h"

#include <stdint.h>
#include <stdlib.h>
#include <ucontext.h>

#define STACK_BYTES (96u << 10)

struct fibre {
    ucontext_t inside, outside;
    void (*fn)(void *arg);
    void *arg;
    bool over;
    char *stack;
};

/* makecontext() passes only ints. */
static void
enter(unsigned high, unsigned low)
{
    struct fibre *f =
        (struct fibre *)((uintptr_t)((uint64_t)high << 32 | (uint64_t)low));

    f->fn(f->arg);
    f->over = true;
    swapcontext(&f->inside, &f->outside);
}

/* getcontext() may return twice, so it has a function of its own. */
static bool
prepare(ucontext_t *at)
{
    return getcontext(at) == 0;
}

static void
make(struct fibre *f)
{
    uint64_t self = (uintptr_t)f;

    f->inside.uc_stack.ss_sp = f->stack;
    f->inside.uc_stack.ss_size = STACK_BYTES;
    f->inside.uc_link = NULL;
    makecontext(&f->inside, (void (*)(void))enter, 2, (unsigned)(self >> 32),
                (unsigned)self);
}

struct fibre *
fibre_new(void (*fn)(void *arg), void *arg)
{
    struct fibre *f = calloc(1, sizeof *f);

    if (!f)
        return NULL;
    f->fn = fn;
    f->arg = arg;
    f->stack = malloc(STACK_BYTES);
    if (!f->stack || !prepare(&f->inside)) {
        fibre_free(f);
        return NULL;
    }
    make(f);
    return f;
}

void
fibre_free(struct fibre *f)
{
    if (!f)
        return;
    free(f->stack);
    free(f);
}

bool
fibre_run(struct fibre *f)
{
    if (!f->over)
        swapcontext(&f->outside, &f->inside);
    return !f->over;
}

void
fibre_yield(struct fibre *f)
{
    swapcontext(&f->inside, &f->outside);
}
