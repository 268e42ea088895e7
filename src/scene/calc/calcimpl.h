/* calcimpl.h - what the parts of calc share (inside scene/calc only) */
#ifndef RAD_SCENE_CALCIMPL_H
#define RAD_SCENE_CALCIMPL_H

#include "base/arena.h"
#include "scene/calc/calc.h"
#include "scene/calc/calcops.h"

#include <stdbool.h>

#define CHECKED 0x80u

enum kind { SYM_UNDEFINED, SYM_VARIABLE, SYM_FUNCTION, SYM_LIBRARY };

struct node;

struct symbol {
    const char *name; /* with its context */
    uint64_t hash;
    enum kind kind;
    bool constant;
    unsigned checked; /* CHECKED and the offer under which all that it leads to
                       * is defined; 0: not looked at */
    int32_t code;     /* of its definition, or of a library function's call */
    int32_t end;      /* behind it */
    int32_t library;  /* index of the function that it names, or -1 */
    int32_t channel;  /* that a variable is another name of, or -1 */
    int32_t real;     /* argument that it is another name of, or 0 */
    int32_t nparams;  /* of a function that a file defines */
    const struct node *body; /* of one whose calls it may replace, or NULL */
    int32_t line;
    const char *file;
};

struct library {
    const char *name;
    int nargs; /* at least; more only where variadic */
    bool variadic;
    bool constant;  /* the same arguments give the same value */
    unsigned offer; /* what it needs of RAD_CALC_OFFER_* */
};
extern const struct library rad_calc_library[];
extern const int rad_calc_nlibrary;

/* ids of those that the compiler treats by itself; the table's order */
enum { LIB_IF, LIB_SELECT, LIB_MIN, LIB_MAX, LIB_ATAN2, LIB_ARG, LIB_PRISM };

/* Value of library function id; *fault may be set. */
double rad_calc_library_value(int id, const double *v,
                              const struct rad_calc_input *in,
                              enum rad_calc_fault *fault);

/* Rays that come out of a pane of prisms, the strongest first. */
#define MAX_PRISM_RAYS 64
struct prism_rays {
    uint64_t clock; /* of the evaluator, when they were found */
    bool sound;     /* the arguments have a meaning */
    int n;
    struct prism_ray {
        double v[3], energy;
        double angle; /* of v in the plane across the ribs */
    } ray[MAX_PRISM_RAYS];
};

/* fprism_val(v[0], v[1], v[2]); finds the rays once for each time of the
 * clock. */
double rad_calc_prism(const double *v, const struct rad_calc_input *in,
                      uint64_t clock, struct prism_rays *out,
                      enum rad_calc_fault *fault);

enum luminaire { LUMINAIRE_CORR, LUMINAIRE_THETA, LUMINAIRE_PHI };
double rad_calc_luminaire(enum luminaire which, const double *v,
                          const struct rad_calc_input *in,
                          enum rad_calc_fault *fault);

/* The global definitions. */
extern const char rad_calc_standard[];

/* FNV-1a of a text. */
uint64_t rad_calc_hash(const char *text);

/* What names mean may change: forget what was compiled (calcmemo.c). */
void rad_calc_forget(struct rad_calc *c);

/* A copy of a tree in the program's arena; NULL: memory is out. */
struct node *rad_calc_copy(struct rad_calc *c, const struct node *n);

/* The number that a call shares with all that are like it, or -1 where its
 * value is not kept (calcsame.c). */
int32_t rad_calc_same(struct rad_calc *c, const struct node *call);

struct known;
#define RAD_CALC_KNOWN_SLOTS 256
#define RAD_CALC_MOST_SAME   256

struct context {
    const char *name; /* "" or "`name" */
    bool loaded;
};

struct rad_calc {
    struct rad_arena arena;
    struct ins *code;
    int32_t ncode, code_size;
    double *number;
    int32_t nnumber, number_size;
    struct symbol *symbol;
    int32_t nsymbol, symbol_size;
    int32_t *slot; /* hash table of symbols, -1: free */
    int32_t nslot; /* a power of two */
    struct known *known[RAD_CALC_KNOWN_SLOTS];   /* lists, by hash */
    const struct node *same[RAD_CALC_MOST_SAME]; /* calls, each once */
    int32_t nsame;
    struct context *context;
    int32_t ncontext;
    struct rad_calc_env *env; /* folds constants */
    bool standard;            /* the global definitions are being read */
    unsigned offer;
};

/* Find or make the symbol that a name stands for in a context.  A name that is
 * defined (not only used) is the context's own.  Returns its index or a code.
 */
int32_t rad_calc_symbol(struct rad_calc *c, const char *context,
                        const char *name, bool defined, struct rad_error *err);

/* A parsed expression. */
struct node {
    enum {
        N_NUMBER,
        N_CHANNEL,
        N_NAME,
        N_PARAM,
        N_VALUE,
        N_NEGATE,
        N_BINARY,
        N_CALL
    } type;
    char op;       /* of N_BINARY: + - * / ^ */
    bool by_param; /* N_CALL: `ref` is a parameter */
    bool literal;  /* N_NUMBER: Radiance has one here, too, once it has read the
                    * expression */
    double number;
    int32_t ref; /* channel, symbol, parameter or value, from 0 */
    int32_t nkids;
    int32_t height; /* of the tree below, bounded: compiling recurses */
    struct node *kid, *next;
};

/* Append the code of an expression and OP_END; returns where it starts. */
int32_t rad_calc_emit(struct rad_calc *c, const struct node *n,
                      struct rad_error *err);

/* The same of an object's expression, whose calls share their values with those
 * of others (calcsame.c). */
int32_t rad_calc_emit_shared(struct rad_calc *c, const struct node *n,
                             struct rad_error *err);

/* Turn a node whose kids are all numbers, or names of functions that only
 * depend on their arguments, into a number, if it always has the same value and
 * no fault. */
void rad_calc_fold(struct rad_calc *c, struct node *n);

/* The number that a constant (c : a*2;) stands for, by what is defined now.
 * False: it has none yet, and is evaluated when it is used. */
bool rad_calc_reduce(struct rad_calc *c, const struct node *body,
                     double *value);

/* Keep the body of a function in the program's arena, so that it may stand
 * where it is called; NULL: it is not one for that, or memory is out. */
const struct node *rad_calc_keep(struct rad_calc *c, const struct node *body);

/* What stands for a call of such a function, in arena; its height is the
 * call's own.  NULL: it stays a call. */
struct node *rad_calc_inlined(struct rad_calc *c, const struct node *call,
                              struct rad_arena *arena);

/* Run code from pc, at most limit instructions. */
double rad_calc_run(const struct rad_calc *c, int32_t pc, int32_t limit,
                    struct rad_calc_env *env, enum rad_calc_fault *fault);

#endif
