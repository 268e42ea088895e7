/* check_ring.c - hundreds of workers: records get about by few links
 *
 * The real coordinator and the real workers, joined by a network in virtual
 * time; a child only makes records, and counts what comes. */
#include "config.h"

#include "front/coord.h"
#include "links/ring.h"
#include "proto/frame.h"
#include "worker/peer.h"
#include "unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST = 300,     /* workers */
    RECORDS = 6000, /* that are made, at most */
    LINKS = 200,    /* open ones of a node */
    TIMES = 600000, /* ms that a test may take */
    CLIENT = 1000,  /* the coordinator's connection of a user */
    RECORD = 4      /* bytes of a record: its number */
};

static const uint8_t job_id[MSG_JOB] = { 7 };
static const uint8_t hash[MSG_HASH] = { 1 };
static const struct msg_frame frame = { 0, 64, 64, "" };

/* An end of a connection, and where what is sent there goes. */
struct end {
    uint64_t conn, other_conn;
    int other;
    uint64_t busy_ms; /* what was sent arrives no sooner */
};

struct node {
    struct worker *machine; /* NULL: dead, or the coordinator */
    char name[16], address[16];
    bool silent;              /* cannot be dialled */
    uint64_t child, since_ms; /* since when it is ready */
    bool ready;
    struct end end[LINKS];
    int nends;
    unsigned random;
    unsigned sent;         /* messages of records to peers */
    unsigned rings, peers; /* RINGs, and JOB_PEERS, that came */
    uint32_t places;       /* of the last RING */
};

struct event {
    struct event *next;
    enum { ARRIVE, DIALLED, CHILD_READY, DIES, COMES, MAKES, SAYS } what;
    int node;
    uint64_t conn;
    size_t len;
    uint8_t bytes[];
};

static struct sim {
    struct coord *coord;
    int n; /* nodes are 1 to n; 0 is the coordinator */
    struct node node[MOST + 1];
    uint64_t now_ms, next_conn, random;
    struct event *due[TIMES], **last[TIMES];
    struct msg msg;
    int maker[RECORDS];
    uint64_t made_ms[RECORDS];
    int nrecords;
    uint8_t got[MOST + 1][RECORDS];
    int apart[2];      /* two that cannot be linked; 0: none */
    uint64_t delay_ms; /* sum over all that came */
    unsigned ncame;
} s;

static unsigned
random_below(unsigned n)
{
    s.random = s.random * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)(s.random >> 33) % n;
}

static void
random_bytes(void *arg, void *buf, size_t n)
{
    (void)arg;
    for (size_t i = 0; i < n; i++)
        ((uint8_t *)buf)[i] = (uint8_t)random_below(256);
}

static bool
has_file(void *arg, const uint8_t *h)
{
    (void)arg;
    (void)h;
    return true;
}

static struct event *
later(uint64_t at_ms, int what, int node, uint64_t conn, const uint8_t *bytes,
      size_t len)
{
    struct event *e = malloc(sizeof *e + len);

    ck_assert(e != NULL && at_ms < TIMES);
    *e = (struct event){ NULL, what, node, conn, len };
    if (len > 0)
        memcpy(e->bytes, bytes, len);
    if (!s.due[at_ms])
        s.last[at_ms] = &s.due[at_ms];
    *s.last[at_ms] = e;
    s.last[at_ms] = &e->next;
    return e;
}

/* --- connections --- */

static struct end *
find_end(int node, uint64_t conn)
{
    for (int i = 0; i < s.node[node].nends; i++)
        if (s.node[node].end[i].conn == conn)
            return &s.node[node].end[i];
    return NULL;
}

static void
add_end(int node, uint64_t conn, int other, uint64_t other_conn)
{
    /* the coordinator's are known by the worker's number */
    if (node == 0)
        return;
    ck_assert_int_lt(s.node[node].nends, LINKS);
    s.node[node].end[s.node[node].nends++] =
        (struct end){ conn, other_conn, other, 0 };
}

static void
remove_end(int node, struct end *e)
{
    *e = s.node[node].end[--s.node[node].nends];
}

static void worker_acts(int node);
static void coord_acts(void);

/* Of the coordinator: a connection's number is that of the worker, in its
 * 1000th life. */
static int
worker_of(uint64_t conn)
{
    return (int)(conn % 1000);
}

static void
carry(int node, uint64_t conn, const uint8_t *bytes, size_t len)
{
    struct end *e = find_end(node, conn);
    uint64_t at = s.now_ms + 1 + random_below(3);

    ck_assert(e != NULL);
    at = at < e->busy_ms ? e->busy_ms : at;
    e->busy_ms = at;
    later(at, ARRIVE, e->other, e->other_conn, bytes, len);
}

/* The other side hears of it. */
static void
close_end(int node, uint64_t conn)
{
    struct end *e = find_end(node, conn);

    if (!e)
        return;
    later(s.now_ms + 2, ARRIVE, e->other, e->other_conn, NULL, 0);
    remove_end(node, e);
}

/* --- children --- */

/* Its radd hears of it after what it is at. */
static void
child_says(int node, const struct msg *m)
{
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&out, m), 0);
    later(s.now_ms + 1, SAYS, node, s.node[node].child, out.buf, out.len);
    wire_out_release(&out);
}

static void
child_said(const struct event *e)
{
    struct node *w = &s.node[e->node];

    if (!w->machine || !w->child || w->child != e->conn)
        return;
    ck_assert_int_eq(msg_unpack(&s.msg, msg_frame_type(e->bytes, e->len), 0,
                                e->bytes + MSG_HEADER, e->len - MSG_HEADER,
                                NULL),
                     0);
    worker_message(w->machine, s.now_ms, w->child, &s.msg);
    worker_acts(e->node);
}

/* All that it has. */
static void
child_gives(int node, uint32_t to)
{
    struct wire_out data;
    struct msg m = { .type = MSG_AMBIENT };

    wire_out_init(&data, MSG_MAX_AMBIENT);
    for (int i = 0; i < s.nrecords; i++)
        if (s.got[node][i] > 0 || s.maker[i] == node)
            wire_put_u32(&data, (uint32_t)i);
    m.ambient = (struct msg_ambient){ to, (uint32_t)(data.len / RECORD),
                                      data.buf, data.len };
    child_says(node, &m);
    wire_out_release(&data);
}

static void
make_record(int node)
{
    uint8_t data[RECORD] = { 0, 0, (uint8_t)(s.nrecords >> 8),
                             (uint8_t)s.nrecords };
    struct msg m = { .type = MSG_AMBIENT, .ambient = { 0, 1, data, RECORD } };

    if (!s.node[node].ready)
        return;
    ck_assert_int_lt(s.nrecords, RECORDS);
    s.maker[s.nrecords] = node;
    s.made_ms[s.nrecords++] = s.now_ms;
    child_says(node, &m);
}

static void
child_hears(int node, const uint8_t *bytes, size_t len)
{
    struct msg m = { 0 };
    struct wire_in in;

    ck_assert_int_eq(msg_unpack(&m, msg_frame_type(bytes, len), 0,
                                bytes + MSG_HEADER, len - MSG_HEADER, NULL),
                     0);
    if (m.type == MSG_JOB_START)
        later(s.now_ms + 1 + random_below(50), CHILD_READY, node,
              s.node[node].child, NULL, 0);
    else if (m.type == MSG_GIVE)
        child_gives(node, m.give.to);
    if (m.type != MSG_AMBIENT) {
        msg_release(&m);
        return;
    }
    ck_assert_uint_eq(m.ambient.len, (size_t)m.ambient.count * RECORD);
    wire_in_init(&in, m.ambient.data, m.ambient.len);
    for (uint32_t i = 0; i < m.ambient.count; i++) {
        uint32_t id = wire_get_u32(&in);

        ck_assert_uint_lt(id, (uint32_t)s.nrecords);
        s.got[node][id] += s.got[node][id] < 255;
        s.delay_ms += s.now_ms - s.made_ms[id];
        s.ncame++;
    }
    msg_release(&m);
}

/* --- shells --- */

static void
coord_acts(void)
{
    struct action_list *l = coord_actions(s.coord);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];
        int node = worker_of(a.conn);

        if (a.type == ACT_JOB_OPEN)
            coord_job_opened(s.coord, s.now_ms, a.job, a.sequence, 0, NULL);
        else if (a.type == ACT_SEND && a.conn != CLIENT && s.node[node].machine)
            later(s.now_ms + 2, ARRIVE, node,
                  worker_coord(s.node[node].machine), a.bytes, a.len);
    }
    ck_assert(!l->failed);
    actions_clear(l);
}

static void
worker_sends(int node, const struct action *a)
{
    struct node *w = &s.node[node];
    uint16_t type = msg_frame_type(a->bytes, a->len);

    if (a->conn == w->child) {
        child_hears(node, a->bytes, a->len);
        return;
    }
    w->sent += type == MSG_AMBIENT || type == MSG_SPREAD;
    carry(node, a->conn, a->bytes, a->len);
    worker_written(w->machine, s.now_ms, a->conn, a->len);
}

static void
worker_acts(int node)
{
    struct node *w = &s.node[node];
    struct action_list *l = worker_actions(w->machine);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        if (a.type == ACT_SEND)
            worker_sends(node, &a);
        else if (a.type == ACT_CLOSE)
            close_end(node, a.conn);
        else if (a.type == ACT_SPAWN)
            w->child = a.conn;
        else if (a.type == ACT_DIAL)
            later(s.now_ms + 1 + random_below(5), DIALLED, node, a.conn,
                  (const uint8_t *)a.text, strlen(a.text) + 1);
    }
    ck_assert(!l->failed);
    actions_clear(l);
}

/* --- events --- */

static void
join_coord(int node, uint64_t conn)
{
    struct node *w = &s.node[node];
    uint64_t there = (uint64_t)node + 1000 * (2 + s.next_conn++);

    add_end(node, conn, 0, there);
    coord_opened(
        s.coord, s.now_ms, there,
        &(struct coord_peer){ w->name, "daemon", 1u << MSG_ROLE_WORKER, NULL });
    coord_acts();
}

static bool
are_apart(int a, int b)
{
    return (a == s.apart[0] && b == s.apart[1]) ||
           (a == s.apart[1] && b == s.apart[0]);
}

static void
dialled(int node, const struct event *e)
{
    struct node *w = &s.node[node];
    int other = e->len > 1 ? atoi((const char *)e->bytes + 4) : 0;
    uint64_t there = UINT64_C(1) << 40 | ++s.next_conn;

    if (!w->machine)
        return;
    if (other > 0 && (!s.node[other].machine || are_apart(node, other))) {
        worker_closed(w->machine, s.now_ms, e->conn, "refused");
        worker_acts(node);
        return;
    }
    if (other == 0) {
        join_coord(node, e->conn);
    } else {
        add_end(node, e->conn, other, there);
        add_end(other, there, node, e->conn);
        worker_accepted(s.node[other].machine, s.now_ms, there);
        worker_acts(other);
    }
    worker_opened(w->machine, s.now_ms, e->conn);
    worker_acts(node);
}

static void
at_coord(const struct event *e)
{
    uint16_t type = e->len ? msg_frame_type(e->bytes, e->len) : 0;

    if (e->len == 0)
        coord_closed(s.coord, s.now_ms, e->conn, "closed");
    if (e->len > 0) {
        ck_assert_int_eq(msg_unpack(&s.msg, type, 0, e->bytes + MSG_HEADER,
                                    e->len - MSG_HEADER, NULL),
                         0);
        coord_message(s.coord, s.now_ms, e->conn, &s.msg);
    }
    coord_acts();
}

static void
at_worker(const struct event *e)
{
    struct node *w = &s.node[e->node];
    struct end *end = w->machine ? find_end(e->node, e->conn) : NULL;

    if (!end)
        return;
    if (e->len == 0) {
        remove_end(e->node, end);
        worker_closed(w->machine, s.now_ms, e->conn, "closed");
    } else {
        ck_assert_int_eq(msg_unpack(&s.msg, msg_frame_type(e->bytes, e->len), 0,
                                    e->bytes + MSG_HEADER, e->len - MSG_HEADER,
                                    NULL),
                         0);
        w->rings += s.msg.type == MSG_RING;
        w->places = s.msg.type == MSG_RING ? s.msg.ring.places : w->places;
        w->peers += s.msg.type == MSG_JOB_PEERS;
        worker_message(w->machine, s.now_ms, e->conn, &s.msg);
    }
    worker_acts(e->node);
}

static void
child_ready(int node, uint64_t child)
{
    struct msg m = { .type = MSG_READY, .ready = { job_id, .1, 7, 1, 0 } };
    struct node *w = &s.node[node];

    if (!w->machine || w->child != child)
        return;
    w->ready = true;
    w->since_ms = s.now_ms;
    child_says(node, &m);
}

static void
comes(int node)
{
    struct node *w = &s.node[node];
    struct worker_env env = { .has_file = has_file,
                              .random = random_bytes,
                              .program = "radd",
                              .name = w->name,
                              .coordinator = "sim 0",
                              .address = w->silent ? "" : w->address,
                              .threads = 1 };

    if (w->machine)
        return;
    snprintf(w->name, sizeof w->name, "ws%d", node);
    snprintf(w->address, sizeof w->address, "sim %d", node);
    w->machine = worker_new(&env);
    ck_assert_ptr_nonnull(w->machine);
    memset(s.got[node], 0, sizeof s.got[node]);
    worker_start(w->machine, s.now_ms);
    worker_acts(node);
}

static void
dies(int node)
{
    struct node *w = &s.node[node];

    while (w->nends > 0)
        close_end(node, w->end[0].conn);
    worker_free(w->machine);
    w->machine = NULL;
    w->child = 0;
    w->ready = false;
}

static void
happen(struct event *e)
{
    switch (e->what) {
    case ARRIVE:
        if (e->node == 0)
            at_coord(e);
        else
            at_worker(e);
        break;
    case DIALLED:
        dialled(e->node, e);
        break;
    case CHILD_READY:
        child_ready(e->node, e->conn);
        break;
    case DIES:
        dies(e->node);
        break;
    case COMES:
        comes(e->node);
        break;
    case MAKES:
        make_record(e->node);
        break;
    case SAYS:
        child_said(e);
        break;
    }
}

static void
run_ms(unsigned ms)
{
    for (; ms > 0; ms--) {
        struct event *e;

        s.now_ms++;
        while ((e = s.due[s.now_ms]) != NULL) {
            s.due[s.now_ms] = e->next;
            if (!e->next)
                s.last[s.now_ms] = &s.due[s.now_ms];
            happen(e);
            free(e);
        }
        if (s.now_ms % 100 == 0) {
            coord_tick(s.coord, s.now_ms);
            coord_acts();
        }
        for (int i = 1; i <= s.n; i++) /* each at its own time */
            if (s.node[i].machine && (s.now_ms + (unsigned)i * 7) % 100 == 0) {
                worker_tick(s.node[i].machine, s.now_ms);
                worker_acts(i);
            }
    }
}

static void
submit(void)
{
    struct msg m = { .type = MSG_SUBMIT,
                     .submit = { .job = job_id,
                                 .manifest = hash,
                                 .name = "n",
                                 .params = "",
                                 .needs = "",
                                 .estimate = "",
                                 .files = { 1, hash },
                                 .nframes = 1,
                                 .frames = &frame,
                                 .flags = MSG_JOB_SHARE,
                                 .partition = MSG_PART_WINDOW,
                                 .windows = 1024 } };
    struct msg hello = { .type = MSG_HELLO,
                         .hello = { MSG_VERSION_MIN, MSG_VERSION, MSG_ROLE_USER,
                                    "", "t", "", 0, 0 } };

    coord_opened(
        s.coord, s.now_ms, CLIENT,
        &(struct coord_peer){ "user", "ana", 1u << MSG_ROLE_USER, NULL });
    coord_message(s.coord, s.now_ms, CLIENT, &hello);
    coord_file_stored(s.coord, s.now_ms, CLIENT, hash);
    coord_message(s.coord, s.now_ms, CLIENT, &m);
    coord_acts();
}

/* n workers that come within three seconds; mixed: one of them
 * cannot be dialled. */
static void
set_up(int n, bool mixed)
{
    struct coord_env env = { .has_file = has_file,
                             .random = random_bytes,
                             .program = "radcoord",
                             .epoch = 1 };

    memset(&s, 0, sizeof s);
    s.n = n;
    s.coord = coord_new(&env);
    submit();
    for (int i = 1; i <= n; i++) {
        s.node[i].silent = i == 6 && mixed;
        later(1 + random_below(3000), COMES, i, 0, NULL, 0);
    }
    run_ms(9000);
}

static void
tear_down(void)
{
    for (int i = 1; i <= s.n; i++)
        worker_free(s.node[i].machine);
    coord_free(s.coord);
    for (int i = 0; i < TIMES; i++)
        while (s.due[i]) {
            struct event *e = s.due[i];

            s.due[i] = e->next;
            free(e);
        }
    msg_release(&s.msg);
}

/* Each makes some records within two seconds. */
static void
make_records(int each)
{
    for (int i = 1; i <= s.n; i++)
        for (int k = 0; k < each; k++)
            later(s.now_ms + 1 + random_below(2000), MAKES, i, 0, NULL, 0);
}

/* Every record from that one on came to every worker that is there, once. */
static void
check_all_came_once(int from)
{
    for (int r = from; r < s.nrecords; r++)
        for (int i = 1; i <= s.n; i++)
            if (s.node[i].ready && s.got[i][r] != (i != s.maker[r]))
                ck_abort_msg("record %d of %d, made at %llu: %d times at %d", r,
                             s.maker[r], (unsigned long long)s.made_ms[r],
                             s.got[i][r], i);
}

/* Each makes that many more, and all come. */
static void
check_records_come(int each)
{
    int from = s.nrecords;

    make_records(each);
    run_ms(2000 + 1500);
    check_all_came_once(from);
}

static const int sizes[] = { 60, 67, 100, 257, MOST };

START_TEST(each_record_comes_to_each_worker_once)
{
    int n = sizes[_i], most = 0;
    unsigned sent = 0;

    set_up(n, true);
    make_records(3);
    run_ms(2000 + 1500);
    ck_assert_int_eq(s.nrecords, 3 * n);
    check_all_came_once(0);
    for (int i = 1; i <= n; i++) {
        sent += s.node[i].sent;
        most = s.node[i].nends > most ? s.node[i].nends : most;
    }
    printf("%d workers: at most %d links of one, %.1f messages of one for 3 "
           "records of each, %.0f ms on the way\n",
           n, most, (double)sent / n, (double)s.delay_ms / s.ncame);
    if (n > 66) /* up to five digits of a distance, both ways, and a few */
        ck_assert_int_le(most, 2 * 3 * 5 + 12);
    if (n >= 100) /* else each sends three to all */
        ck_assert_uint_lt(sent, (unsigned)(3 * n * (n - 1)) / 2);
    tear_down();
}
END_TEST

static const int few[] = { 3, 4, 8, 40, 64 };

/* They are linked with all: each record goes to each at once. */
START_TEST(few_workers_send_to_each)
{
    int n = few[_i];
    unsigned sent = 0;

    set_up(n, false);
    for (int i = 1; i <= n; i++)
        s.node[i].sent = 0; /* to newcomers, that is */
    make_records(3);
    run_ms(2000 + 1500);
    check_all_came_once(0);
    for (int i = 1; i <= n; i++)
        sent += s.node[i].sent;
    ck_assert_uint_eq(sent, (unsigned)(3 * n * (n - 1)));
    dies(1 + n / 2);
    run_ms(100);
    check_records_come(1);
    comes(1 + n / 2);
    run_ms(1000);
    check_records_come(1);
    tear_down();
}
END_TEST

/* Which it held, and should by now: made while both were there. */
static void
count_held(uint64_t until_ms, unsigned *held, unsigned *due)
{
    for (int r = 0; r < s.nrecords; r++)
        for (int i = 1; i <= s.n; i++) {
            const struct node *w = &s.node[i];

            if (!w->ready || i == s.maker[r] || s.made_ms[r] > until_ms ||
                w->since_ms > s.made_ms[r])
                continue;
            ++*due;
            *held += s.got[i][r] > 0;
        }
}

/* Workers go and come all the time. */
START_TEST(nearly_all_comes_while_workers_come_and_go)
{
    int n = 150;
    unsigned held = 0, due = 0;

    set_up(n, true);
    for (int i = 0; i < 15; i++) {
        int a = 1 + (int)random_below((unsigned)n);

        later(s.now_ms + 1 + 1000 * (unsigned)i, DIES, a, 0, NULL, 0);
        later(s.now_ms + 1 + 1000 * (unsigned)i + random_below(5000), COMES, a,
              0, NULL, 0);
    }
    for (int i = 0; i < 8; i++) {
        make_records(1);
        run_ms(2000);
    }
    run_ms(2000);
    count_held(s.now_ms - 2000, &held, &due);
    printf("%u of %u records came while workers came and went\n", held, due);
    ck_assert_uint_gt(due, 100000);
    ck_assert_uint_gt(held, due - due / 50);
    /* newcomers have what there was, too */
    for (int i = 1; i <= n; i++)
        later(s.now_ms + 1, COMES, i, 0, NULL, 0);
    run_ms(8000);
    for (int i = 1; i <= n; i++) {
        int has = 0;

        ck_assert(s.node[i].ready);
        for (int r = 0; r < s.nrecords; r++)
            has += s.got[i][r] > 0 || s.maker[r] == i;
        ck_assert_int_gt(has, s.nrecords * 9 / 10);
    }
    check_records_come(2);
    tear_down();
}
END_TEST

/* Links of some break, though both ends live and the coordinator hears of it
 * from neither. */
static void
break_links(int n)
{
    for (int i = 1; i <= n; i += 3) {
        struct node *w = &s.node[i];
        struct end e = w->end[1 + random_below((unsigned)w->nends - 1)];

        if (e.other == 0)
            continue;
        later(s.now_ms + 1, ARRIVE, i, e.conn, NULL, 0);
        later(s.now_ms + 1, ARRIVE, e.other, e.other_conn, NULL, 0);
    }
    run_ms(10);
}

static const int broken[] = { 8, 100 };

START_TEST(a_link_that_breaks_is_made_again)
{
    int n = broken[_i];

    set_up(n, n > 64);
    for (int times = 0; times < 4; times++) {
        break_links(n);
        make_records(1); /* by which they find that */
        run_ms(6000);
        check_records_come(2);
    }
    tear_down();
}
END_TEST

/* Two that are to be linked on the ring, of which neither is special. */
static void
keep_two_apart(int n)
{
    const struct node *w = &s.node[n];
    int other = 0;

    for (int i = 0; i < w->nends && !other; i++)
        if (w->end[i].other > 6)
            other = w->end[i].other;
    ck_assert_int_ne(other, 0);
    s.apart[0] = n;
    s.apart[1] = other;
}

/* The firewall between them is there before their link, or comes later. */
START_TEST(two_that_cannot_be_linked_do_not_trouble_the_others)
{
    int n = 100;
    unsigned rings;

    set_up(n, true);
    keep_two_apart(n - 1);
    for (int i = 0; i < 2; i++) {
        struct node *w = &s.node[s.apart[i]];

        for (int k = 0; k < w->nends; k++)
            if (w->end[k].other == s.apart[!i])
                later(s.now_ms + 1, ARRIVE, s.apart[i], w->end[k].conn, NULL,
                      0);
    }
    for (int i = 0; i < 16; i++) {
        make_records(1); /* by which they find that */
        run_ms(2500);
    }
    rings = s.node[1].rings;
    for (int i = 0; i < 6; i++)
        check_records_come(1);
    ck_assert_uint_eq(s.node[1].rings, rings);
    /* one that begins anew is given a place again */
    s.apart[0] = s.apart[1] = 0;
    dies(n - 1);
    run_ms(100);
    comes(n - 1);
    run_ms(6000);
    check_records_come(1);
    ck_assert_int_gt(s.node[n - 1].nends, 6);
    tear_down();
}
END_TEST

START_TEST(there_is_one_way_from_each_place_to_each_other)
{
    static const uint32_t places[] = { 1, 2, 3, 4, 5, 16, 17, 64, 65, 1000 };
    uint32_t n = places[_i], offset, below, most = 0;
    uint32_t *hops = calloc(n, sizeof *hops), *seen = calloc(n, sizeof *seen);

    ck_assert(hops && seen);
    seen[0] = 1;
    for (uint32_t d = 0; d < n; d++) { /* what is passed on is farther */
        ck_assert_uint_eq(seen[d], 1);
        for (uint32_t i = 0; ring_link(n, i, &offset, &below); i++) {
            ck_assert_uint_le(below, offset);
            if (d >= below || offset >= n - d)
                continue;
            seen[d + offset]++;
            hops[d + offset] = hops[d] + 1;
        }
        most = hops[d] > most ? hops[d] : most;
    }
    ck_assert_uint_le(most, n > 256 ? 5 : n > 64 ? 4 : 3);
    free(hops);
    free(seen);
}
END_TEST

int
main(void)
{
    Suite *suite = suite_create("ring");
    TCase *tc = tcase_create("ring");

    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, there_is_one_way_from_each_place_to_each_other, 0,
                        10);
    tcase_add_loop_test(tc, each_record_comes_to_each_worker_once, 0,
                        N_ELEM(sizes));
    tcase_add_loop_test(tc, few_workers_send_to_each, 0, N_ELEM(few));
    tcase_add_test(tc, nearly_all_comes_while_workers_come_and_go);
    tcase_add_loop_test(tc, a_link_that_breaks_is_made_again, 0,
                        N_ELEM(broken));
    tcase_add_test(tc, two_that_cannot_be_linked_do_not_trouble_the_others);
    suite_add_tcase(suite, tc);
    return unit_run(suite);
}
