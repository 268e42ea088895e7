/* fuzz_calc.c - function files, and expressions that use them
 *
 * Up to the first NUL a file of definitions, behind it an expression. */
#include "scene/calc/calc.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

static void
run(const struct rad_calc *c, int at)
{
    static const double args[] = { 1, 0, 2.5, 1, 1.5, .01, 4, 0, .1, .2 };
    double channel[RAD_CALC_NCHANNELS] = { 1, 0, 0, 0, 0, 1, 3, 4, 5, 9, 1 };
    struct rad_calc_input in = { channel, args, 10 };
    struct rad_calc_env *env = rad_calc_env_new(c);
    struct rad_calc_need need;
    enum rad_calc_fault fault;

    if (!env)
        return;
    rad_calc_begin(env, &in);
    rad_calc_eval(c, at, env, &fault);
    /* what any ray needs this one did, too */
    rad_calc_needs(c, at, &need);
    if (fault <= RAD_CALC_MATH && (need.reals > in.nargs || need.function))
        abort();
    rad_calc_env_free(env);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *nul = size ? memchr(data, 0, size) : NULL;
    size_t len = nul ? (size_t)(nul - data) : size;
    struct rad_error err = { 0 };
    struct rad_calc *c = rad_calc_new(&err);
    /* all variables that any material has */
    if (c)
        rad_calc_offer(c, RAD_CALC_OFFER_NORMAL | RAD_CALC_OFFER_COLOR |
                              RAD_CALC_OFFER_AIM);
    int context = c ? rad_calc_context(c, "fuzz.cal", &err) : -1;

    if (context >= 0 && rad_calc_read(c, context, "fuzz.cal",
                                      (const char *)data, len, &err) == 0) {
        char *text =
            nul ? strndup((const char *)nul + 1, size - len - 1) : strdup("x");
        struct rad_calc_compiled is, again;
        int rc = text ? rad_calc_compile(c, context, text, &is, &err) : -1;

        if (rc == 0)
            run(c, is.code);
        else if (text && err.code == 0)
            abort();
        if (rc == 0 && (rad_calc_compile(c, context, text, &again, NULL) < 0 ||
                        again.code != is.code))
            abort();
        free(text);
    } else if (err.code == 0) {
        abort();
    }
    rad_calc_free(c);
    return 0;
}
