/* calcops.h - the instructions that functions are compiled to (inside
 * scene/calc only)
 *
 * Code is an array of instructions; a piece of code ends with OP_END.  A call
 * is
 *     CALL n symbol, n words ARG_AT pc, one word RESUME pc, the arguments
 * where each argument is a piece of its own, run when it is first used.  A call
 * whose value is kept for equal calls (calcsame.c) has SHARED and one word
 * RESUME pc before it, and SHARE after it.  A call of arg() with a plain number
 * has REAL and one word RESUME pc before it. */
#ifndef RAD_SCENE_CALCOPS_H
#define RAD_SCENE_CALCOPS_H

#include <stdint.h>

enum op {
    OP_END,
    OP_NUMBER,  /* push number[a] */
    OP_CHANNEL, /* push channel a */
    OP_VARIABLE,
    OP_PARAM,
    OP_VALUE, /* push value a of rad_calc_call() */
    OP_NEGATE,
    OP_ADD,
    OP_SUBTRACT,
    OP_MULTIPLY,
    OP_ADD_NUMBER, /* with number[a] instead of the second value */
    OP_SUBTRACT_NUMBER,
    OP_MULTIPLY_NUMBER,
    OP_DIVISOR,    /* if 0 is on the stack: a fault, go on at a */
    OP_DIVIDE,     /* the divisor is below the dividend */
    OP_POWER,      /* the exponent is below the base */
    OP_CLEAR,      /* drop faults */
    OP_CHECK,      /* if there is a fault, or no finite number: 0 and a fault */
    OP_UNLESS,     /* pop; if not above 0, go on at a */
    OP_JUMP,       /* go on at a */
    OP_SELECT,     /* pop; go on at one of the n ARG_AT words, or at a */
    OP_LIBRARY,    /* function a on n values */
    OP_CALL,       /* symbol a with n arguments */
    OP_CALL_PARAM, /* the function that parameter a names */
    OP_SHARED,     /* if the value of class a is known: push it, go to RESUME's
                    * pc */
    OP_SHARE,      /* keep the top value for class a */
    OP_REAL, /* if arg(a) is there and finite: clear, push it, go to RESUME's
              * pc */
    OP_ARG_AT,
    OP_RESUME,
    OP_HALT /* not in code: the evaluator runs it after a fault that ends all */
};

struct ins {
    uint16_t op;
    uint16_t n;
    int32_t a;
};

#endif
