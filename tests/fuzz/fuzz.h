/* fuzz.h - what libFuzzer and replay.c call */
#ifndef RADD_TESTS_FUZZ_H
#define RADD_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
