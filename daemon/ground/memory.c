/* memory.c - see memory.h */
#include "config.h"

#include "ground/memory.h"

#include "net/log.h"

#include <openssl/crypto.h>
#include <stdlib.h>
#include <uv.h>

static void *
need(void *p)
{
    if (!p)
        log_out_of_memory();
    return p;
}

void *
memory_need(size_t n)
{
    return need(malloc(n));
}

static void *
need_realloc(void *p, size_t n)
{
    p = realloc(p, n);
    return n > 0 ? need(p) : p;
}

static void *
need_calloc(size_t n, size_t size)
{
    return need(calloc(n, size));
}

/* libcrypto's allocators get its source file and line, too. */
static void *
crypto_malloc(size_t n, const char *file, int line)
{
    (void)file;
    (void)line;
    return n > 0 ? memory_need(n) : NULL;
}

static void *
crypto_realloc(void *p, size_t n, const char *file, int line)
{
    (void)file;
    (void)line;
    return need_realloc(p, n);
}

static void
crypto_free(void *p, const char *file, int line)
{
    (void)file;
    (void)line;
    free(p);
}

void
memory_catch(void)
{
    CRYPTO_set_mem_functions(crypto_malloc, crypto_realloc, crypto_free);
    uv_replace_allocator(memory_need, need_realloc, need_calloc, free);
}
