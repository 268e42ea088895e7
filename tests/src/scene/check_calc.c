/* check_calc.c - tests of src/scene/calc: what expressions of function files
 * are worth, when they are evaluated, which are refused; and of src/base/xform
 */
#include "config.h"

#include "base/xform.h"
#include "scene/calc/calc.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* What $1, $2, ... and arg(1), ... are in the tests. */
static double channel[RAD_CALC_NCHANNELS];
static const double args[] = { 2, -3, .5 };

/* The value of an expression in the context of a file of that text. */
static double
evaluate(const char *file, const char *text, enum rad_calc_fault *fault)
{
    struct rad_error err = { 0 };
    struct rad_calc_input in = { channel, args, N_ELEM(args) };
    struct rad_calc *calc = rad_calc_new(&err);
    struct rad_calc_env *env;
    int context, at;
    double v;

    ck_assert_msg(calc != NULL, "%s: %s", err.where, err.what);
    for (int i = 0; i < RAD_CALC_NCHANNELS; i++)
        channel[i] = i + 1;
    context = rad_calc_context(calc, file ? "test.cal" : ".", &err);
    ck_assert_int_ge(context, 0);
    if (file)
        rad_calc_read(calc, context, "test.cal", file, strlen(file), &err);
    at = rad_calc_expression(calc, context, text, &err);
    ck_assert_msg(at >= 0 && !err.code, "%s: %s: %s", text, err.where,
                  err.what);
    env = rad_calc_env_new(calc);
    ck_assert_ptr_nonnull(env);
    rad_calc_begin(env, &in);
    v = rad_calc_eval(calc, at, env, fault);
    ck_assert(rad_calc_eval(calc, at, env, fault) == v);
    rad_calc_env_free(env);
    rad_calc_free(calc);
    return v;
}

static struct rad_calc *c;

static void
set_up(void)
{
    c = rad_calc_new(NULL);
}

static void
tear_down(void)
{
    rad_calc_free(c);
}

FIXTURE(set_up, tear_down)

static const struct {
    const char *file, *name;
    int n, nparams;
    double value; /* for 7, 11, 13 */
} called[] = {
    { "f(a) = 2*a;", "f", 1, 1, 14 },
    { "f(a) = 2*a;", "f", 3, 1, 14 }, /* what is too much is not used */
    { "f(a,b,c) = 100*a+10*b+c;", "f", 3, 3, 823 },
    { "f(a) = a+$2;", "f", 1, 1, 9 }, /* channels are there, too */
    { "f(a) = g(a,a); g(a,b) = a*b*A1;", "f", 1, 1, 98 },
    { "", "noop", 1, 1, 7 },
    { "", "green", 3, 3, 11 },
    { "", "max", 3, 1, 13 },
    { "", "atan2", 3, 2, .56672921752350635 /* atan(7/11) */ },
};

LOOP_TEST(function_is_called_by_its_name, N_ELEM(called))
{
    static const double value[] = { 7, 11, 13 };
    const char *file = called[_i].file, *name = called[_i].name;
    struct rad_calc_input in = { channel, args, N_ELEM(args) };
    int context = rad_calc_context(c, "test.cal", NULL), f;
    enum rad_calc_fault fault;
    struct rad_calc_env *env;

    for (int i = 0; i < RAD_CALC_NCHANNELS; i++)
        channel[i] = i + 1;
    rad_calc_read(c, context, "test.cal", file, strlen(file), NULL);
    ck_assert_int_eq(rad_calc_params(c, context, name, NULL),
                     called[_i].nparams);
    f = rad_calc_function(c, context, name, called[_i].n, NULL);
    ck_assert_int_ge(f, 0);
    env = rad_calc_env_new(c);
    ck_assert_ptr_nonnull(env);
    rad_calc_begin(env, &in);
    ck_assert_double_eq_tol(rad_calc_call(c, f, value, env, &fault),
                            called[_i].value, 1e-9);
    ck_assert_int_eq(fault, RAD_CALC_SOUND);
    rad_calc_env_free(env);
}

static const double blues[] = { 3, -2, 0, -0., INFINITY, -INFINITY, NAN };

/* blue() has a short cut; f() is the same by the machine. */
LOOP_TEST(value_of_a_colour_is_not_negative, N_ELEM(blues))
{
    static const char text[] = "f(r,g,b)=noneg(noop(b));";
    int context = rad_calc_context(c, "test.cal", NULL), blue, f;
    double value[3] = { 7, -7, blues[_i] }, v, w;
    enum rad_calc_fault fault, same;
    struct rad_calc_env *env;

    ck_assert_int_eq(
        rad_calc_read(c, context, "test.cal", text, strlen(text), NULL), 0);
    blue = rad_calc_function(c, context, "blue", 3, NULL);
    f = rad_calc_function(c, context, "f", 3, NULL);
    ck_assert(blue >= 0 && f >= 0);
    env = rad_calc_env_new(c);
    ck_assert_ptr_nonnull(env);
    rad_calc_go_on(env, RAD_CALC_MATH);
    v = rad_calc_call(c, blue, value, env, &fault);
    rad_calc_go_on(env, RAD_CALC_MATH);
    w = rad_calc_call(c, f, value, env, &same);
    ck_assert(v == w && fault == same);
    ck_assert(v == (blues[_i] == 3 ? 3 : 0));
    rad_calc_env_free(env);
}

/* What calls are about takes no memory for each of them. */
TEST(argument_of_calls_in_calls_is_there_once)
{
    int context = rad_calc_context(c, "test.cal", NULL);
    char *text = malloc(1 << 20), *p = text;
    struct rusage before, after;

    ck_assert_ptr_nonnull(text);
    p += sprintf(p, "f = ");
    for (int i = 0; i < 190; i++)
        p += sprintf(p, "noop(");
    p += sprintf(p, "select(1");
    for (int i = 0; i < 30000; i++)
        p += sprintf(p, ",$%d", i % 9 + 1);
    p += sprintf(p, ")");
    for (int i = 0; i < 190; i++)
        p += sprintf(p, ")");
    p += sprintf(p, ";");
    getrusage(RUSAGE_SELF, &before);
    ck_assert_int_eq(
        rad_calc_read(c, context, "test.cal", text, (size_t)(p - text), NULL),
        0);
    getrusage(RUSAGE_SELF, &after);
    ck_assert_int_lt(after.ru_maxrss - before.ru_maxrss, 64 << 10); /* KiB */
    free(text);
}

static const struct {
    const char *file, *name, *problem;
} uncalled[] = {
    { "f = 1;", "f", "undefined function 'f'" },
    { "", "nope", "undefined function 'nope'" },
    { "f(a) = nope;", "f", "undefined variable 'nope'" },
    { "f(a) = a;", "f+1", "no name of a function" },
    { "", "", "no name of a function" },
    { "", "2", "no name of a function" },
    { "", "atan2", "too few arguments for atan2()" },
};

LOOP_TEST(what_is_no_function_is_not_called, N_ELEM(uncalled))
{
    const char *file = uncalled[_i].file;
    int context = rad_calc_context(c, "test.cal", NULL);
    struct rad_error err = { 0 };

    rad_calc_read(c, context, "test.cal", file, strlen(file), NULL);
    ck_assert_int_eq(rad_calc_function(c, context, uncalled[_i].name, 1, &err),
                     RAD_EDATA);
    ck_assert_msg(strstr(err.what, uncalled[_i].problem) != NULL, "%s",
                  err.what);
}

/* A luminaire of 2 by 3 by 4, or 2 across and 3 high, of multiplier 10, seen
 * along D from P. */
static const struct {
    const char *text;
    double D[3], value;
} luminaire[] = {
    { "source_corr(5,0)", { 0, 0, 1 }, 50 },
    { "source_corr(-5,0)", { 0, 0, 1 }, 0 },
    { "source_corr(5,1)", { 0, 0, 1 }, 100 }, /* over Rdot */
    { "source_corr(5,2)", { .6, 0, -.8 }, 50 / (.6 * 12 + .8 * 6) },
    { "source_corr(5,2)", { 0, 1, 0 }, 50 / 8. },
    { "source_corr(5,4)", { .6, 0, .8 }, 50 / (6 * .6 + M_PI * .8) },
    { "source_corr(5,4)",
      { 0, 0, 1 },
      50 / (6 * 1.4142132088e-3 + M_PI * .999999) },
    /* from (2, 1, 0), 1 off the box's side of 3 by 4 */
    { "source_corr(5,3)", { 1, 0, 0 }, 50 * 10 / 12. },
    { "source_theta(180)", { 0, 0, -1 }, 180 },
    { "source_theta(180)", { .5, 0, -.8660254037844386 }, 150 },
    { "source_theta(180)", { 0, 0, 1.0000001 }, 0 },
    { "source_phi(360)", { 1, 1, 0 }, 225 },
    { "source_phi(360)", { 1, -1, 0 }, 135 },
    { "source_phi(360)", { -1, 1, 0 }, 315 },
    { "source_phi(180)", { -1, 1, 0 }, 45 },
    { "source_phi(180)", { 1, 1, 0 }, 135 },
    { "source_phi(90)", { 1, 1, 0 }, 45 },
    { "source_phi(90)", { 1, -2, 0 }, 63.43494882292201 },
    { "source_phi(90)", { -1, 2, 0 }, 63.43494882292201 },
};

LOOP_TEST(luminaire_is_corrected_for_its_shape, N_ELEM(luminaire))
{
    static const double sizes[] = { 10, 2, 3, 4 };
    struct rad_calc_input in = { channel, sizes, N_ELEM(sizes) };
    int at = rad_calc_expression(c, rad_calc_context(c, ".", NULL),
                                 luminaire[_i].text, NULL);
    struct rad_calc_env *env;
    enum rad_calc_fault fault;

    ck_assert_int_ge(at, 0);
    memset(channel, 0, sizeof channel);
    memcpy(channel, luminaire[_i].D, sizeof luminaire[_i].D);
    channel[6] = 12; /* P */
    channel[7] = 1;
    channel[10] = .5; /* Rdot */
    channel[24] = 10; /* Ts */
    env = rad_calc_env_new(c);
    ck_assert_ptr_nonnull(env);
    rad_calc_begin(env, &in);
    ck_assert_double_eq_tol(rad_calc_eval(c, at, env, &fault),
                            luminaire[_i].value, 1e-9);
    ck_assert_int_eq(fault, RAD_CALC_SOUND);
    rad_calc_env_free(env);
}

static const struct {
    const char *text;
    double value;
} expression[] = {
    { "1+2*3", 7 },
    { "(1+2)*3", 9 },
    { "7-2-1", 4 },
    { "8/4/2", 1 },
    { "8/4*2", 4 },
    { "2^3^2", 512 },
    { "-2^2", 4 }, /* the sign binds first */
    { "0-2^2", -4 },
    { "2^-1", .5 },
    { "2*-3", -6 },
    { "+5", 5 },
    { "1.5e1 + .5", 15.5 },
    { "if(1e400-5,3,4)", 3 }, /* a number may be infinite */
    { "1/1e400", 0 },
    { "min(1e400,7)", 7 },
    { "1 {a {nested} comment} + 1", 2 },
    { "if(1,2,3)", 2 },
    { "if(0,2,3)", 3 },
    { "if(-1,2,3)", 3 },
    { "if(1,2,1/0)", 2 }, /* what is not chosen does not count */
    { "select(0,5,6,7)", 3 },
    { "select(2,5,6,7)", 6 },
    { "select(2.6,5,6,7)", 7 },
    { "min(3,1,2)", 1 },
    { "max(3,1,7,2)", 7 },
    { "max(4)", 4 },
    { "atan2(1,1)", M_PI / 4 },
    { "sqrt(2)", 1.4142135623730951 },
    { "floor(-1.5)", -2 },
    { "ceil(-1.5)", -1 },
    { "log10(1000)", 3 },
    { "erf(.5)", .5204998778130465 },
    { "PI/DEGREE", 180 },
    { "mod(-1,3)", 2 },
    { "tri(5,2)", 1 },
    { "frac(-.25)", .75 },
    { "bound(0,7,1)", 1 },
    { "inside(0,.5,1)", .5 },
    { "xor(1,1)", -1 },
    { "and(1,-2)", -2 },
    { "Acos(2)", 0 },
    { "sgn(-7)", -1 },
    { "abs(-7)", 7 },
    { "atan2(abs(A1-A1),-1)", M_PI }, /* abs(0) is 0, not -0 */
    { "linterp(.25,2,4)", 2.5 },
    { "hermite(1,2,0,0,.5)", 1.5 },
    { "hermite(1,2,3,4,.25)", 1.390625 },
    { "bezier(1,2,3,4,.3)", 1.9 },
    { "bspline(1,2,3,4,.3)", 2.3 },
    { "bspline(0,1,0,0,0)", 2. / 3 },
    { "fade(2,1,1)", 1.5 },
    { "fade(2,1,17)", 1 },
    { "grey(1,1,1)", 1 },
    { "unif2norm(.5)", 0 },
    { "unif2norm(.975)", 1.959964 },
    { "AC+A1*A2", 3 - 6 },
    { "arg(3)", .5 },
    { "$10+T", 20 },
    { "Dx*100+Ny*10+Pz", 100 + 50 + 9 },
    { "D(3)+N(1)+P(2)", 3 + 4 + 8 },
    { "Ts", 25 },
    { "3-A1", 1 },
    { "A1-3", -1 },
    { "3*A1+4", 10 },
    { "4+A1*3", 10 },
    { "Lv", 27 },
    { "dot(D,N)", 1 * 4 + 2 * 5 + 3 * 6 },
    { "cross(3,D,N)", 1 * 5 - 2 * 4 },
};

LOOP_TEST(expression_has_its_value, N_ELEM(expression))
{
    enum rad_calc_fault fault;
    double v = evaluate(NULL, expression[_i].text, &fault);

    ck_assert_int_eq(fault, RAD_CALC_SOUND);
    /* the normal quantile is good to 4.5e-4 by its source */
    ck_assert_msg(fabs(v - expression[_i].value) <=
                      (strstr(expression[_i].text, "unif") ? 4.5e-4 : 1e-12),
                  "%s = %.17g", expression[_i].text, v);
}

static const struct {
    const char *file, *text;
    double value;
} scoped[] = {
    { "a = 2; b = a*3;", "b", 6 },
    { "b = a*3; a = 2;", "b", 6 }, /* in any order */
    { "f(x,y) = x-y;", "f(5,3)", 2 },
    { "f(x) = x*x; g(x) = f(x+1);", "g(2)", 9 },
    { "x = 10; f(x) = x;", "f(1)+x", 11 },
    { "fact(n) = if(n-1.5, n*fact(n-1), 1);", "fact(10)", 3628800 },
    { "fib(n):if(n-1.5,fib(n-1)+fib(n-2),n);", "fib(12)", 144 },
    { "two(f,x) = f(f(x)); sq2(x) = x*x;", "two(sq2,3)", 81 },
    { "two(f,x) = f(f(x));", "two(sqrt,16)", 2 },
    { "two(f,x) = f(f(x)); four(g,x) = two(g,two(g,x)); h(x)=2*x;", "four(h,1)",
      16 },
    { "f(x) = 1; g(x) = g(x);", "f(g(1))", 1 }, /* not needed, not run */
    { "PI : 3;", "PI", 3 },                     /* the file's own */
    { "PI : 3;", "PI`", M_PI },                 /* the global one */
    { "y = PI; PI : 3;", "y", M_PI },           /* bound when read */
    { "y = `PI; `PI = 3;", "y", 3 },
    { "sin(x) = 7;", "sin(0)", 7 },
    { "a = 1; a = 2;", "a", 2 },
    { "c : 4; d = c; c : 5;", "d", 4 }, /* a constant's value when read */
    { "a = 4; c : a*2; a = 5;", "c", 8 },
    { "a.b_c1 = 3;", "a.b_c1", 3 },
    { ";;a = 1;;", "a", 1 },
    { "a = 1", "a", 1 }, /* the last ; may lack */
    { "\xef\xbb\xbf{ b } a = 1;", "a", 1 },
    { "n=select(3,1,2,f(2)); f(x)=x+1;", "n", 3 },
    { "c = $2; f(x) = x-c; g(y) = f(y);", "g($1)", -1 },
    { "f(x) = x+x*x; g(y) = f(y);", "g(sq(3))", 90 },
    { "f(x) = x*2; g(y) = f(y)+y; h(z) = z+g(z);", "h(A1+1)", 12 },
    { "r = arg(1); r = arg(2);", "r", -3 }, /* the last, of whatever kind */
    { "c = $3; c(x) = x;", "c(4)", 4 },
    { "c = $3; c = 4;", "c", 4 },
    { "c(x) = x; c = $3;", "c", 3 },
    { "c = 4; c = arg(1);", "c", 2 },
    { "clip(x) = x/4;", "clip(2)", .5 }, /* not the one that all have */
    { "f(x) = clip(x); clip(x) = x/4;", "f($1)", 1 },
    { "f(x) = and(x-1,x); g(y) = bound(0,f(y),y+1);", "g(A1*2)", 4 },
};

LOOP_TEST(names_are_found_in_their_scope, N_ELEM(scoped))
{
    enum rad_calc_fault fault;
    double v = evaluate(scoped[_i].file, scoped[_i].text, &fault);

    ck_assert_int_eq(fault, RAD_CALC_SOUND);
    ck_assert_double_eq_tol(v, scoped[_i].value, 1e-12);
}

TEST(files_do_not_see_each_others_names)
{
    struct rad_error err = { 0 };
    int a = rad_calc_context(c, "lib/a.cal", &err);
    int b = rad_calc_context(c, "b.cal", &err);

    ck_assert_int_ne(a, b);
    ck_assert_int_eq(rad_calc_context(c, "lib_a.CAL", &err), a);
    ck_assert_int_eq(rad_calc_read(c, a, "lib/a.cal", "own = 1;", 8, &err), 0);
    ck_assert(rad_calc_loaded(c, a) && !rad_calc_loaded(c, b));
    ck_assert_int_ge(rad_calc_expression(c, a, "own", &err), 0);
    ck_assert_int_eq(rad_calc_expression(c, b, "own", &err), RAD_EDATA);
    ck_assert_str_eq(err.what, "undefined variable 'own'");
}

static const struct {
    const char *file, *text;
    enum rad_calc_fault fault;
    double value;
} faulty[] = {
    { NULL, "1+sqrt(-A1)", RAD_CALC_MATH, 1 },
    { NULL, "1/(A1-2)", RAD_CALC_MATH, 0 },
    { NULL, "cos(1/(A1-2))", RAD_CALC_MATH, 0 },       /* not cos(0) */
    { NULL, "1/(A1-2)+cos(A1-2)", RAD_CALC_SOUND, 1 }, /* forgotten */
    { NULL, "1/(A1-2)+cos(0*A1)", RAD_CALC_MATH, 1 },  /* that is a number */
    { NULL, "log(A1-2)*red(.5,-1,A1)", RAD_CALC_SOUND, 0 },
    { NULL, "and(log(A1-2),1)", RAD_CALC_MATH, 0 },
    { NULL, "and(A1)", RAD_CALC_NO_ARG, 0 },       /* it is needed */
    { NULL, "A2+1/(A1-2)+A2", RAD_CALC_MATH, -6 }, /* it was known */
    { "f(x) = A1/(A1-2)+x;", "f(Dz)", RAD_CALC_MATH, 3 },
    { NULL, "if(1,log(A1-2),3)", RAD_CALC_MATH, 0 },
    { NULL, "A2^.5", RAD_CALC_MATH, 0 },
    { NULL, "(1+log(A2))^arg(1)", RAD_CALC_MATH, 0 },
    { NULL, "arg(1)^log(A2)", RAD_CALC_SOUND, 1 }, /* forgotten for arg() */
    { NULL, "atan2(1+log(A2),arg(1))", RAD_CALC_MATH, 0 },
    { NULL, "atan2(arg(1),log(A2))", RAD_CALC_SOUND, M_PI / 2 },
    { NULL, "exp(1000*A1)", RAD_CALC_MATH, 0 },
    { NULL, "select(A1,7)", RAD_CALC_MATH, 0 },
    { NULL, "A4+1", RAD_CALC_NO_ARG, 0 },
    { "f(x)=f(x)+1;", "f(1)", RAD_CALC_DEPTH, 0 },
    { "v = w; w = v;", "v", RAD_CALC_DEPTH, 0 },
    { "f(x)=x(1);", "f(A1)", RAD_CALC_NAME, 0 },
    { "f(x)=1; g(y)=y;", "g(f)", RAD_CALC_NAME, 0 },
    { "f(x,y)=y;", "f(1)", RAD_CALC_NO_ARG, 0 },
    { "f(n)=if(n,f(n-1)+f(n-1),A1);", "f(40)", RAD_CALC_STEPS, 0 },
};

/* What Radiance finds out when it reads an expression: log(A2) has no value,
 * arg(9) and nope are not there. */
static const struct {
    const char *file, *text;
    double value;
    enum rad_calc_fault fault;
} folded[] = {
    { NULL, ".3+0*log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+log(A2)*0", .3, RAD_CALC_SOUND },
    { NULL, ".3+0/log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+0^log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+log(A2)^0", 1.3, RAD_CALC_SOUND },
    { NULL, ".3+1^log(A2)", 1.3, RAD_CALC_SOUND },
    { NULL, ".3+0*arg(9)", .3, RAD_CALC_SOUND },
    { NULL, ".3+0*nope", .3, RAD_CALC_SOUND },
    { NULL, ".3+nope(A1)^0", 1.3, RAD_CALC_SOUND },
    { NULL, ".3+-0*log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+log(A2)*-(1-1)", .3, RAD_CALC_SOUND },
    { NULL, ".3+0*A1*log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+A1*0*log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+log(A2)*(A1*0)", .3, RAD_CALC_SOUND },
    { NULL, ".3+if(1,0,0)*log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+log(A2)*sin(0*A1)", .3, RAD_CALC_SOUND },
    { NULL, ".3+noise3(0,0,0)*log(A2)", .3, RAD_CALC_SOUND },
    { NULL, ".3+noneg(-2)*log(A2)", .3, RAD_CALC_SOUND },
    { "z : 0;", ".3+z*log(A2)", .3, RAD_CALC_SOUND },
    { "o = 1; z : o-o;", ".3+z*log(A2)", .3, RAD_CALC_SOUND },
    { "z(x) : x-3;", ".3+z(3)*log(A2)", .3, RAD_CALC_SOUND },
    { "z(f) : f(0);", ".3+z(sin)*log(A2)", .3, RAD_CALC_SOUND },
    { "h(x) : x-3; z(f) : f(3);", ".3+z(h)*log(A2)", .3, RAD_CALC_SOUND },
    /* what it does not */
    { NULL, ".3+(A1-A1)*log(A2)", .3, RAD_CALC_MATH },
    { NULL, ".3+if(A1,0,0)*log(A2)", .3, RAD_CALC_MATH },
    { NULL, ".3+red(0,A1,1)*log(A2)", .3, RAD_CALC_MATH },
    { NULL, ".3+1*log(A2)", .3, RAD_CALC_MATH },
    { NULL, "1/(A1-2)+A2^1", -3, RAD_CALC_MATH }, /* a power forgets it */
    { NULL, "1/(A1-2)+A2^2", 9, RAD_CALC_SOUND },
    { NULL, ".3+0*A1/(1-1)", .3, RAD_CALC_MATH },
    { "z = 0;", ".3+z*log(A2)", .3, RAD_CALC_MATH },
    { "z(x) = x-3;", ".3+z(3)*log(A2)", .3, RAD_CALC_MATH },
    { "h(x) = x-3; z(f) : f(3);", ".3+z(h)*log(A2)", .3, RAD_CALC_MATH },
};

LOOP_TEST(literals_decide_when_an_expression_is_read, N_ELEM(folded))
{
    enum rad_calc_fault fault;
    double v = evaluate(folded[_i].file, folded[_i].text, &fault);

    ck_assert_msg(fault == folded[_i].fault, "%s: fault %d", folded[_i].text,
                  (int)fault);
    ck_assert_double_eq_tol(v, folded[_i].value, 1e-12);
}

/* Values of calls are kept while the ray is the same. */
static const struct {
    const char *text[2]; /* the second evaluated again, after the first */
    double value;        /* of that; and twice as much for twice Dx */
    enum rad_calc_fault fault;
} shared[] = {
    { { "f(3)", "f(3)" }, 3, RAD_CALC_SOUND },
    { { "f(3)+f(3)", "f(2)+f(3)-f(2)" }, 3, RAD_CALC_SOUND },
    { { "f(A1)", "f(A1)*f(f(1))" }, 2, RAD_CALC_SOUND },
    { { "f(0)", "f(-0)" }, 0, RAD_CALC_SOUND },
    { { "f(2)", "log(A2)+f(2)" }, 2, RAD_CALC_MATH },
    { { "f(2)", "log(A2)+g(2)" }, 2, RAD_CALC_SOUND }, /* forgotten */
    { { "g(2)", "log(A2)+g(2)" }, 2, RAD_CALC_SOUND },
    { { "h(2)", "h(2)" }, 0, RAD_CALC_MATH },
    { { "1+0*h(2)", "f(1)+h(2)" }, 1, RAD_CALC_MATH },
};

LOOP_TEST(what_a_call_gives_is_kept_for_a_ray, N_ELEM(shared))
{
    static const char text[] =
        "f(x) = x*Dx; g(x) = max(x*Dx,0); h(x) = log(-x*Dx);";
    double dx[RAD_CALC_NCHANNELS] = { 1 }, real[] = { 2, -3 };
    struct rad_calc_input in = { dx, real, 2 };
    struct rad_calc_env *e;
    enum rad_calc_fault fault;
    int context = rad_calc_context(c, "x.cal", NULL), pc[2];

    rad_calc_read(c, context, "x.cal", text, sizeof text - 1, NULL);
    for (int i = 0; i < 2; i++) {
        pc[i] = rad_calc_expression(c, context, shared[_i].text[i], NULL);
        ck_assert_int_ge(pc[i], 0);
    }
    e = rad_calc_env_new(c);
    for (int times = 1; times <= 2; times++) {
        dx[0] = times;
        rad_calc_begin(e, &in);
        rad_calc_eval(c, pc[0], e, &fault);
        for (int again = 0; again < 2; again++) {
            double v = rad_calc_eval(c, pc[1], e, &fault), want;

            want = shared[_i].value;
            for (int k = 1; k < times; k++)
                want *= strchr(shared[_i].text[1], '*') ? 8 : 2;
            ck_assert_msg(v == want, "%s is %g", shared[_i].text[1], v);
            ck_assert_int_eq(fault, shared[_i].fault);
        }
    }
    rad_calc_env_free(e);
}

/* 16384 values have room on the stack.  Each of 3275 calls leaves five there,
 * and some more are there before; then the value that is kept is pushed. */
LOOP_TEST(value_that_is_kept_is_not_pushed_beyond_the_end_of_the_stack, 12)
{
    static const char file[] =
        "f(x) = x*Dx;"
        "deep(n,x) = if(n, n+(n+(n+(n+(n+deep(n-1,x))))), n+x);";
    double dx[RAD_CALC_NCHANNELS] = { 1 }, real[] = { 1 };
    struct rad_calc_input in = { dx, real, 1 };
    int context = rad_calc_context(c, "x.cal", NULL), pc;
    struct rad_calc_env *e;
    enum rad_calc_fault fault;
    char text[128] = "f(2)+(";
    double v;

    for (int k = 0; k < _i; k++)
        strcat(text, "A1+(");
    strcat(text, "deep(3275,f(2))");
    for (int k = 0; k < _i; k++)
        strcat(text, ")");
    strcat(text, "+max(A1,2))"); /* which drops faults */
    rad_calc_read(c, context, "x.cal", file, sizeof file - 1, NULL);
    pc = rad_calc_expression(c, context, text, NULL);
    ck_assert_int_ge(pc, 0);
    e = rad_calc_env_new(c);
    rad_calc_begin(e, &in);
    v = rad_calc_eval(c, pc, e, &fault);
    ck_assert_int_eq(fault, _i < 7 ? RAD_CALC_SOUND : RAD_CALC_DEPTH);
    ck_assert_double_eq(v, _i < 7 ? 5 * 3275 * 3276 / 2 + 6 + _i : 0);
    rad_calc_env_free(e);
}

LOOP_TEST(fault_is_told_and_bounded, N_ELEM(faulty))
{
    enum rad_calc_fault fault;
    double v = evaluate(faulty[_i].file, faulty[_i].text, &fault);

    ck_assert_msg(fault == faulty[_i].fault, "%s: fault %d", faulty[_i].text,
                  (int)fault);
    ck_assert_double_eq_tol(v, faulty[_i].value, 1e-12);
}

static const struct {
    const char *text, *where, *what;
} bad[] = {
    { "a = 1;\nb = ;\n", "bad.cal:2", "expected a value, got ';'" },
    { "a = 1\nb = 2;", "bad.cal:2", "expected ';', got 'b'" },
    { "a = (1;", "bad.cal:1", "expected ')', got ';'" },
    { "\n\n{ open", "bad.cal:3", "comment without an end" },
    { "3 = 4;", "bad.cal:1", "expected a name to define, got '3'" },
    { "a 4;", "bad.cal:1", "expected '=' or ':', got '4'" },
    { "f(1) = 4;", "bad.cal:1", "expected a parameter's name, got '1'" },
    { "f(a`b) = 4;", "bad.cal:1", "parameter's name holds '`'" },
    { "a = 1e;", "bad.cal:1", "number lacks its exponent" },
    { "a = .;", "bad.cal:1", "badly formed number" },
    { "a = $28;", "bad.cal:1", "no such channel" },
    { "a = --1;", "bad.cal:1", "expected a value, got '-'" },
    { "a = atan2(1);", "bad.cal:1", "too few arguments for atan2()" },
    { "a = sin();", "bad.cal:1", "expected a value, got ')'" },
};

LOOP_TEST(bad_text_is_refused_with_its_line, N_ELEM(bad))
{
    struct rad_error err = { 0 };
    int context = rad_calc_context(c, "bad.cal", &err);

    ck_assert_int_eq(rad_calc_read(c, context, "bad.cal", bad[_i].text,
                                   strlen(bad[_i].text), &err),
                     RAD_EDATA);
    ck_assert_str_eq(err.where, bad[_i].where);
    ck_assert_str_eq(err.what, bad[_i].what);
}

TEST(undefined_name_is_refused_where_it_is_used)
{
    static const char text[] = "a = 1;\nb = a+nope;\nc = 2;";
    struct rad_error err = { 0 };
    int context = rad_calc_context(c, "bad.cal", &err);

    ck_assert_int_eq(
        rad_calc_read(c, context, "bad.cal", text, strlen(text), &err), 0);
    ck_assert_int_ge(rad_calc_expression(c, context, "a+c", &err), 0);
    ck_assert_int_eq(rad_calc_expression(c, context, "b", &err), RAD_EDATA);
    ck_assert_str_eq(err.where, "bad.cal:2");
    ck_assert_str_eq(err.what, "undefined variable 'nope'");
}

/* Deep and long input must not reach the end of C's stack. */
TEST(expression_is_compiled_once_while_names_mean_the_same)
{
    int a = rad_calc_context(c, "a.cal", NULL);
    int b = rad_calc_context(c, "b.cal", NULL);
    struct rad_calc_compiled first, again, other;

    rad_calc_read(c, b, "b.cal", "k : 3;", 6, NULL);
    rad_calc_read(c, a, "a.cal", "k : 2;", 6, NULL);
    ck_assert_int_eq(rad_calc_compile(c, a, "k*arg(4)*Nx", &first, NULL), 0);
    ck_assert_int_eq(rad_calc_compile(c, a, "k*arg(4)*Nx", &again, NULL), 0);
    ck_assert_int_eq(again.code, first.code);
    ck_assert_int_eq(again.need.reals, 4);
    ck_assert_uint_eq(again.channels, rad_calc_channels(c, first.code));
    rad_calc_offer(c, RAD_CALC_OFFER_AIM); /* it might need what is new */
    ck_assert_int_eq(rad_calc_compile(c, a, "k*arg(4)*Nx", &other, NULL), 0);
    ck_assert_int_ne(other.code, first.code);
    rad_calc_compile(c, a, "k", &first, NULL);
    rad_calc_compile(c, b, "k", &other, NULL);
    ck_assert(first.is_number && first.number == 2);
    ck_assert(other.is_number && other.number == 3);
    rad_calc_read(c, a, "a.cal", "k : 5;", 6, NULL);
    rad_calc_compile(c, a, "k", &again, NULL);
    ck_assert(again.is_number && again.number == 5);
    ck_assert_int_lt(rad_calc_compile(c, a, "k+", &again, NULL), 0);
    ck_assert_int_lt(rad_calc_compile(c, a, "k+", &again, NULL), 0);
}

/* What a program writes that knows no data files. */
TEST(table_of_ifs_is_read)
{
    char text[20000] = "";
    enum rad_calc_fault fault;
    size_t len = 0;

    for (int i = 0; i < 1000; i++)
        len += (size_t)sprintf(text + len, "if(%d-A1,%d,", 2 * i - 1000, i);
    text[len++] = '7';
    memset(text + len, ')', 1000);
    ck_assert_double_eq(evaluate(NULL, text, &fault), 502); /* A1 is 2 */
}

TEST(nesting_is_bounded)
{
    static char text[400001];
    struct rad_error err = { 0 };

    memset(text, '(', 400000);
    ck_assert_int_eq(rad_calc_expression(c, 0, text, &err), RAD_EDATA);
    for (int i = 0; i < 400000; i += 2)
        memcpy(text + i, "T+", 2);
    text[399999] = '\0';
    err = (struct rad_error){ 0 };
    ck_assert_int_eq(rad_calc_expression(c, 0, text, &err), RAD_EDATA);
    ck_assert_str_eq(err.what, "expression of too many terms");
    for (int i = 0; i < 400000; i += 2)
        memcpy(text + i, "T^", 2);
    err = (struct rad_error){ 0 };
    ck_assert_int_eq(rad_calc_expression(c, 0, text, &err), RAD_EDATA);
}

/* Noise is 0 on the lattice, and its slope along an axis there is the gradient
 * that the lattice point has, +-1 or 0. */
TEST(noise_follows_its_definition)
{
    enum rad_calc_fault fault;
    double x;

    ck_assert_double_eq_tol(evaluate(NULL, "noise3(3,-4,17)", &fault), 0,
                            1e-15);
    x = evaluate(NULL, "noise3x(3,7,17)", &fault);
    ck_assert_double_eq_tol(x, round(x), 1e-5);
    /* the published reference implementation's value at this point */
    ck_assert_double_eq_tol(evaluate(NULL, "noise3(3.14,42,7)", &fault),
                            0.13691995878400012, 1e-12);
    x = evaluate(NULL, "fnoise3(.3,.4,.5)", &fault);
    ck_assert(x >= -1.5 && x <= 1.5 && x != 0);
    /* at a lattice point the corner's own number */
    ck_assert_double_eq_tol(evaluate(NULL, "fnoise3(.99999,1,1)", &fault),
                            evaluate(NULL, "fnoise3(1.00001,1,1)", &fault),
                            .01);
}

TEST(rand_follows_its_formula)
{
    enum rad_calc_fault fault;
    double x = 5 * (1 / 26. + 2.71828182845904);

    x = 1e5 / (x + .785398163397447 - floor(x));
    ck_assert_double_eq_tol(evaluate(NULL, "rand(5)", &fault), x - floor(x),
                            1e-9);
}

/* --- transforms ---------------------------------------------------------- */

static const struct {
    const char *words[12];
    int n;
    double p[3], q[3], scale;
} xform[] = {
    { { "-t", "1", "2", "3" }, 4, { 1, 1, 1 }, { 2, 3, 4 }, 1 },
    { { "-rz", "90" }, 2, { 1, 0, 0 }, { 0, 1, 0 }, 1 },
    { { "-rx", "90" }, 2, { 0, 1, 0 }, { 0, 0, 1 }, 1 },
    { { "-ry", "90" }, 2, { 0, 0, 1 }, { 1, 0, 0 }, 1 },
    { { "-s", "2", "-t", "1", "0", "0" }, 6, { 1, 1, 1 }, { 3, 2, 2 }, 2 },
    { { "-t", "1", "0", "0", "-s", "-2" }, 6, { 1, 1, 1 }, { -4, -2, -2 }, 2 },
    { { "-mx" }, 1, { 1, 2, 3 }, { -1, 2, 3 }, 1 },
    { { "-i", "3", "-t", "1", "0", "0" }, 6, { 0, 0, 0 }, { 3, 0, 0 }, 1 },
    { { "-i", "0", "-t", "1", "0", "0" }, 6, { 0, 0, 0 }, { 0, 0, 0 }, 1 },
    { { "-i", "1", "-rx", "-90", "-ry", "90" },
      6,
      { 0, 1, 0 },
      { -1, 0, 0 },
      1 },
};

LOOP_TEST(transform_moves_a_point_and_back, N_ELEM(xform))
{
    struct rad_xform x, back;
    double q[3];

    ck_assert_int_eq(rad_xform_parse(&x, xform[_i].words, xform[_i].n, NULL),
                     0);
    rad_xform_point(q, &x, xform[_i].p);
    for (int i = 0; i < 3; i++)
        ck_assert_double_eq_tol(q[i], xform[_i].q[i], 1e-14);
    ck_assert_double_eq_tol(x.scale, xform[_i].scale, 1e-15);
    rad_xform_invert(&back, &x);
    rad_xform_point(q, &back, q);
    for (int i = 0; i < 3; i++)
        ck_assert_double_eq_tol(q[i], xform[_i].p[i], 1e-14);
}

static const struct {
    const char *words[4];
    int n;
} bad_xform[] = {
    { { "-t", "1", "2" }, 3 },
    { { "-s", "0" }, 2 },
    { { "-s", "x" }, 2 },
    { { "-rw", "1" }, 2 },
    { { "3" }, 1 },
    { { "-i", "1.5" }, 2 },
    { { "-t", "1", "2", "nan" }, 4 },
    { { "-s", "1e200" }, 2 },
};

LOOP_TEST(bad_transform_is_refused, N_ELEM(bad_xform))
{
    struct rad_xform x;
    struct rad_error err = { 0 };

    ck_assert_int_eq(
        rad_xform_parse(&x, bad_xform[_i].words, bad_xform[_i].n, &err),
        RAD_EDATA);
    ck_assert_str_ne(err.what, "");
}
