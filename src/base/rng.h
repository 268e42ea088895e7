/* rng.h - random numbers as a function of where they are used
 *
 * There is no generator and no state: a number depends on a 64-bit key and a
 * dimension alone.  A pixel's key comes from seed, frame and pixel; each ray
 * that is spawned gets a key of its own, from its parent's key and its branch.
 * So a pixel has the same value whatever thread, worker or order renders it.
 * Mixing: the finalizer of SplitMix64 (Steele, Lea & Flood 2014, Fast
 * splittable pseudorandom number generators). */
#ifndef RAD_BASE_RNG_H
#define RAD_BASE_RNG_H

#include <stdint.h>

static inline uint64_t
rad_mix64(uint64_t z)
{
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/* The key of a branch of whatever has this key. */
static inline uint64_t
rad_key_branch(uint64_t key, uint64_t branch)
{
    return rad_mix64(key + UINT64_C(0x9e3779b97f4a7c15) * (branch + 1));
}

static inline uint64_t
rad_key_frame(uint64_t seed, uint32_t frame)
{
    return rad_key_branch(rad_mix64(seed), frame);
}

/* The key of a pixel of the frame that has this key. */
static inline uint64_t
rad_key_in_frame(uint64_t key, uint32_t x, uint32_t y)
{
    return rad_key_branch(key, (uint64_t)y << 32 | x);
}

static inline uint64_t
rad_key_pixel(uint64_t seed, uint32_t frame, uint32_t x, uint32_t y)
{
    return rad_key_in_frame(rad_key_frame(seed, frame), x, y);
}

/* Random number number dim of this key: uniform in [0, 1), 53 bits. */
static inline double
rad_rand(uint64_t key, uint32_t dim)
{
    /* the high bit keeps these keys apart from those of branches */
    uint64_t k = rad_key_branch(key, (uint64_t)dim | UINT64_C(1) << 63);

    return (double)(k >> 11) * 0x1p-53;
}

#endif
