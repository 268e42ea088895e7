/* calcimpl.h - shared by the files of calc (inside scene/calc only) */
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
    unsigned checked; /* CHECKED and the offer with which all that it reaches is
                       * defined; 0: not checked */
    int32_t code;     /* of its definition, or of a call of a library
                       * function */
    int32_t end;      /* of that code */
    int32_t library;  /* index of the library function of that name, or -1 */
    int32_t channel;  /* for a variable like Dx=$1: the channel, or -1 */
    int32_t real;     /* for a variable like A1=arg(1): the argument, or 0 */
    int32_t nparams;  /* of a function that a file defines */
    const struct node *body; /* of a function that is inlined, or NULL */
    int32_t line;
    const char *file;
};

struct library {
    const char *name;
    int nargs; /* at least so many; more only if variadic */
    bool variadic;
    bool constant;  /* the value depends on the arguments alone */
    unsigned offer; /* RAD_CALC_OFFER_* that it needs */
};
extern const struct library rad_calc_library[];
extern const int rad_calc_nlibrary;

/* ids of functions with code of their own in the compiler; the table's order */
enum { LIB_IF, LIB_SELECT, LIB_MIN, LIB_MAX, LIB_ATAN2, LIB_ARG, LIB_PRISM };

/* The value of library function id for arguments v; *fault may be set. */
double rad_calc_library_value(int id, const double *v,
                              const struct rad_calc_input *in,
                              enum rad_calc_fault *fault);

/* Rays that leave a pane of prisms, the strongest first. */
#define MAX_PRISM_RAYS 64
struct prism_rays {
    uint64_t clock; /* the evaluator's, when the rays were found */
    bool sound;     /* the pane's arguments make sense */
    int n;
    struct prism_ray {
        double v[3], energy;
        double angle; /* of v in the plane across the ribs */
    } ray[MAX_PRISM_RAYS];
};

/* fprism_val(v[0], v[1], v[2]).  The rays are found once for each value of the
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

/* The meaning of names may change: forget compiled expressions (calcmemo.c). */
void rad_calc_forget(struct rad_calc *c);

/* A copy of a tree in the program's arena; NULL: memory is out. */
struct node *rad_calc_copy(struct rad_calc *c, const struct node *n);

/* The number of the class of equal calls that a call belongs to, or -1 if its
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
    int32_t ncode;
    double *number;
    int32_t nnumber;
    struct symbol *symbol;
    int32_t nsymbol;
    int32_t *slot; /* hash table of symbols, -1: free */
    int32_t nslot; /* a power of two */
    struct known *known[RAD_CALC_KNOWN_SLOTS];   /* lists, by hash */
    const struct node *same[RAD_CALC_MOST_SAME]; /* one call of each class */
    int32_t nsame;
    struct context *context;
    int32_t ncontext;
    struct rad_calc_env *env; /* to evaluate constants */
    bool standard;            /* the global definitions are being read */
    unsigned offer;
};

/* Find or make the symbol that a name stands for in a context.  If it is to be
 * defined, the symbol is the context's own.  Returns its index or a code. */
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
    bool by_param; /* N_CALL: `ref` is a parameter that names the function */
    bool literal;  /* N_NUMBER: in Radiance it is a number, too, once the
                    * expression is read */
    double number;
    int32_t ref; /* channel, symbol, parameter or value, from 0 */
    int32_t nkids;
    int32_t height; /* of the tree below; limited, because compiling recurses */
    struct node *kid, *next;
};

/* The n of a call arg(n) with a whole number, as in A1=arg(1); 0: the node is
 * another. */
int32_t rad_calc_real(const struct rad_calc *c, const struct node *n);

/* Append the code of an expression and OP_END; returns where it starts. */
int32_t rad_calc_emit(struct rad_calc *c, const struct node *n,
                      struct rad_error *err);

/* The same for an object's expression, whose calls share their values with
 * equal calls in others (calcsame.c). */
int32_t rad_calc_emit_shared(struct rad_calc *c, const struct node *n,
                             struct rad_error *err);

/* Replace a node by a number if it always has the same value without a fault.
 * Its kids must be numbers, or names of functions that depend on their
 * arguments alone. */
void rad_calc_fold(struct rad_calc *c, struct node *n);

/* The value of a constant (c : a*2;), with the definitions of now.  False: it
 * has none yet, and is evaluated when used. */
bool rad_calc_reduce(struct rad_calc *c, const struct node *body,
                     double *value);

/* Keep a copy of a function's body in the program's arena, for inlining; NULL:
 * it is not suited, or memory is out. */
const struct node *rad_calc_keep(struct rad_calc *c, const struct node *body);

/* The expression that replaces a call of such a function, in arena; the height
 * of its root is not set.  NULL: the call stays. */
struct node *rad_calc_inlined(struct rad_calc *c, const struct node *call,
                              struct rad_arena *arena);

/* Run code from pc, at most limit instructions. */
double rad_calc_run(const struct rad_calc *c, int32_t pc, int32_t limit,
                    struct rad_calc_env *env, enum rad_calc_fault *fault);

#endif
