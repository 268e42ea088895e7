/* check_task.c - work behind the loop: grouped, held while there is no room,
 * and ended when the disk fails */
#include "config.h"

#include "ground/task.h"
#include "tests/unit.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct fixture {
    uv_loop_t loop;
    struct task_queue q;
    char log[400]; /* what ran (letters), was settled (|) and done (capitals) */
    _Atomic int run_code, settle_code; /* what they return */
    int settled;
    _Atomic char short_of; /* that letter fails for want of means */
    bool full, broken;
    enum task_lack lack;
};

struct letter {
    struct task task;
    struct fixture *f;
    char c;
};

static struct fixture f;
static pthread_mutex_t log_lock = PTHREAD_MUTEX_INITIALIZER;

/* From the loop and from the pool. */
static void
note(char c)
{
    pthread_mutex_lock(&log_lock);
    size_t n = strlen(f.log);

    ck_assert_uint_lt(n + 1, sizeof f.log);
    f.log[n] = c;
    pthread_mutex_unlock(&log_lock);
}

/* Is any of these in the log? */
static bool
noted(const char *chars)
{
    pthread_mutex_lock(&log_lock);
    bool is = strpbrk(f.log, chars) != NULL;

    pthread_mutex_unlock(&log_lock);
    return is;
}

static int
run_letter(struct task *t)
{
    struct letter *l = (struct letter *)t;

    note(l->c);
    if (l->c == f.short_of)
        return rad_fail(&t->err, t->waits ? RAD_EFULL : RAD_ESHORT,
                        "none for %c", l->c);
    return t->writes && f.run_code
               ? rad_fail(&t->err, f.run_code, "no %c", l->c)
               : 0;
}

static void
letter_done(struct task *t)
{
    struct letter *l = (struct letter *)t;

    note(t->code < 0 ? '!' : (char)(l->c - 'a' + 'A'));
    free(l);
}

static struct letter *
new_letter(char c, bool writes)
{
    struct letter *l = calloc(1, sizeof *l);

    ck_assert_ptr_nonnull(l);
    l->task.run = run_letter;
    l->task.done = letter_done;
    l->task.writes = l->task.lasts = writes;
    l->c = c;
    return l;
}

static void
push(char c, bool writes)
{
    task_push(&f.q, &new_letter(c, writes)->task);
}

static void
letter_waits(struct task *t)
{
    (void)t;
    note('?');
}

static int
settle(void *arg, struct rad_error *err)
{
    (void)arg;
    f.settled++;
    note('|');
    return f.settle_code ? rad_fail(err, f.settle_code, "not settled") : 0;
}

static void
lacks(void *arg, enum task_lack what, const char *text)
{
    (void)arg;
    ck_assert_str_ne(text, "");
    f.full = what != TASK_LACKS_NOTHING;
    f.lack = what;
}

static void
broken(void *arg, const struct rad_error *err)
{
    (void)arg;
    ck_assert_int_ne(err->code, 0);
    f.broken = true;
}

static const struct task_ops ops = { settle, lacks, broken };

static void
set_up(void)
{
    memset(&f, 0, sizeof f);
    uv_loop_init(&f.loop);
    task_queue_init(&f.q, &f.loop, &ops, &f);
}

static void
turn(void)
{
    uv_run(&f.loop, UV_RUN_ONCE);
}

static void
go(void)
{
    while (!task_queue_idle(&f.q))
        turn();
}

static void
tear_down(void)
{
    task_queue_end(&f.q);
    go();
    task_queue_release(&f.q);
    ck_assert_int_eq(uv_loop_close(&f.loop), 0);
}

FIXTURE(set_up, tear_down)

TEST(what_lasts_is_done_when_it_is_settled)
{
    push('a', true);
    go();
    ck_assert_str_eq(f.log, "a|A");
    push('b', false); /* it does not */
    go();
    ck_assert_str_eq(f.log, "a|AbB");
}

/* Not before the last settling is a while ago, however long all of it takes. */
TEST(what_comes_within_a_while_is_settled_together)
{
    uint64_t begin = uv_hrtime(), most;

    f.q.gather = true;
    for (char c = 'a'; c <= 'z'; c++) {
        push(c, true);
        turn();
    }
    go();
    most = 1 + (uv_hrtime() - begin) / (TASK_GATHER_MS * 1000000u);
    ck_assert_uint_le((uint64_t)f.settled, most);
    for (char c = 'A'; c < 'Z'; c++)
        ck_assert(strchr(f.log, c) < strchr(f.log, c + 1));
}

TEST(what_is_awaited_is_settled_at_once)
{
    struct letter *c = new_letter('c', true);

    f.q.gather = true;
    push('a', true);
    go();
    push('b', true); /* it may wait for others */
    c->task.awaited = true;
    task_push(&f.q, &c->task);
    while (!noted("c"))
        turn();
    push('d', true);
    go();
    ck_assert_ptr_nonnull(strstr(f.log, "c|"));
}

static const int passing[] = { RAD_EFULL, RAD_ESHORT, RAD_ENOMEM };

LOOP_TEST(a_lack_holds_what_writes, 3)
{
    f.run_code = passing[_i];
    push('a', true);
    push('b', true);
    push('c', false);
    while (!noted("C") || !f.full)
        turn();
    ck_assert(!noted("AB!"));
    ck_assert_int_eq(f.lack, _i == 0 ? TASK_LACKS_ROOM : TASK_LACKS_MEANS);
    ck_assert(!task_queue_idle(&f.q));
    f.run_code = 0;
    go();
    ck_assert(!f.full);
    ck_assert(strchr(f.log, 'A') && strchr(f.log, 'A') < strchr(f.log, 'B'));
    ck_assert_ptr_null(strchr(f.log, '!'));
}

/* Others read and write meanwhile. */
TEST(reading_waits_for_means_alone)
{
    f.short_of = 'a';
    push('a', false);
    push('b', false);
    push('c', true);
    while (!noted("B") || !noted("C"))
        turn();
    ck_assert(!noted("A!") && !f.full);
    f.short_of = '\0';
    go();
    ck_assert(noted("A"));
}

/* Readers follow each other until nothing is lacking. */
static void
read_on(struct task *t)
{
    if (f.lack == TASK_LACKS_NOTHING) {
        letter_done(t);
    } else {
        memset(f.log, 0, sizeof f.log);
        task_push(&f.q, t);
    }
}

static int
run_nothing(struct task *t)
{
    (void)t;
    return 0;
}

TEST(a_queue_that_is_never_idle_tries_again)
{
    struct letter *l = new_letter('z', false);

    f.short_of = 'a';
    push('a', true);
    while (f.lack == TASK_LACKS_NOTHING)
        turn();
    l->task.run = run_nothing;
    l->task.done = read_on;
    f.short_of = '\0';
    task_push(&f.q, &l->task);
    go();
    ck_assert(noted("A") && noted("Z"));
}

TEST(what_wants_much_room_waits_alone)
{
    struct letter *l = new_letter('a', true);

    l->task.waits = letter_waits;
    f.short_of = 'a';
    task_push(&f.q, &l->task);
    push('b', true);
    while (!noted("B"))
        turn();
    ck_assert(noted("?") && !noted("A!") && !f.full && !f.broken);
    f.short_of = '\0';
    go();
    ck_assert(noted("A"));
    ck_assert_ptr_eq(strchr(f.log, '?'), strrchr(f.log, '?')); /* told once */
}

TEST(what_cannot_be_settled_for_room_runs_again)
{
    f.settle_code = RAD_EFULL;
    push('a', true);
    while (!f.full)
        turn();
    f.settle_code = 0;
    go();
    ck_assert_str_eq(f.log, "a|a|A");
    ck_assert(!f.full && !f.broken);
}

TEST(what_cannot_be_settled_runs_again_before_what_is_held)
{
    f.short_of = 'b';
    f.settle_code = RAD_EFULL;
    push('z', false); /* meanwhile the others come together */
    push('a', true);
    push('b', true);
    while (!f.full)
        turn();
    f.short_of = '\0';
    f.settle_code = 0;
    memset(f.log, 0, sizeof f.log);
    go();
    ck_assert_str_eq(f.log, "ab|AB");
}

TEST(what_is_held_is_given_up_in_the_end)
{
    f.run_code = RAD_EFULL;
    push('a', true);
    while (!f.full)
        turn();
    task_queue_end(&f.q);
    go();
    ck_assert_ptr_nonnull(strchr(f.log, '!'));
}

/* Nor does what follows run, though it lacks nothing: it may stand on that. */
TEST(what_follows_what_is_given_up_in_the_end_is_given_up)
{
    f.short_of = 'a';
    push('a', true);
    while (!f.full)
        turn();
    push('b', true);
    push('c', false);
    task_queue_end(&f.q);
    go();
    ck_assert(!noted("Bb"));
    ck_assert(noted("C"));
    ck_assert(!f.broken); /* no failure of the disk */
}

LOOP_TEST(a_disk_that_fails_ends_it, 2)
{
    if (_i)
        f.settle_code = RAD_EIO;
    else
        f.run_code = RAD_EIO;
    push('a', true);
    go();
    ck_assert(f.broken);
    ck_assert_str_eq(f.log, _i ? "a|!" : "a!");
    f.run_code = f.settle_code = 0; /* it may have come to its senses */
    push('b', true);
    push('c', false);
    go();
    ck_assert(!noted("Bb"));
    ck_assert(noted("C"));
}

TEST(what_fails_for_its_own_sake_ends_nothing)
{
    f.run_code = RAD_EPROTO;
    push('a', true);
    go();
    ck_assert_str_eq(f.log, "a!");
    ck_assert(!f.broken && !f.full);
}
