/* calcops.h - the instructions that functions are compiled to (inside
 * scene/calc only)
 *
 * Code is an array of instructions; a piece of it ends with OP_END.  A call is
 *     CALL n symbol, n words ARG_AT pc, one word RESUME pc, the arguments
 * where each argument is a piece of its own, run when it is first needed.  One
 * whose value is kept for others like it (calcsame.c) has SHARED and one word
 * RESUME pc before it, and SHARE behind it. */
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
    OP_ADD_NUMBER, /* the same with number[a] instead of the stack's top */
    OP_SUBTRACT_NUMBER,
    OP_MULTIPLY_NUMBER,
    OP_DIVISOR, /* 0 on the stack: a fault, go on at a; else nothing */
    OP_DIVIDE,  /* the divisor lies below */
    OP_POWER, /* the exponent lies below */
    OP_CLEAR,      /* forget faults */
    OP_CHECK,      /* a fault, or no finite number: 0 and a fault */
    OP_UNLESS,     /* pop; not above 0: go on at a */
    OP_JUMP,       /* go on at a */
    OP_SELECT,     /* pop; go on at one of the n ARG_AT words, or at a */
    OP_LIBRARY,    /* function a on n values */
    OP_CALL,       /* symbol a with n arguments */
    OP_CALL_PARAM, /* the function that parameter a names */
    OP_SHARED, /* call a is known: push it and go on at the RESUME word behind */
    OP_SHARE,  /* the stack's top is the value of call a */
    OP_ARG_AT,
    OP_RESUME,
    OP_HALT /* in no code: what the evaluator runs after a fault that ends it */
};

struct ins {
    uint16_t op;
    uint16_t n;
    int32_t a;
};

#endif
