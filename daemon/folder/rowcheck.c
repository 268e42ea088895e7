/* rowcheck.c - see rowcheck.h */
#include "config.h"

#include "folder/rowcheck.h"

/* Make the unit new, as if no worker had had it: rows of the former attempt
 * that are still to come count as late. */
static void
make_new(struct saved_unit *u)
{
    u->worker = "";
    u->fingerprint = 0;
    u->stored = 0;
    u->sum = 0;
    u->done = false;
    u->end_ms = 0;
    u->bottom = NULL;
    u->nbottom = 0;
}

struct check {
    struct folder *f;
    const struct saved_job *saved;
    bool given_up;
    struct saved_unit *units;
    rowcheck_fn *damaged;
    void *arg;
    struct rad_error *err;
};

/* Are the unit's rows as the journal's sum says, and is the base line that they
 * end with in that sum, for it was kept?  A unit without densities may have
 * such a line, where each pixel is traced; so both sums are tried then. */
static int
look(const struct check *c, const struct saved_unit *u, bool *sound, bool *line)
{
    struct partition_area kept = u->area;

    kept.height = u->stored;
    *sound = *line = false;
    for (int with = u->nbottom > 0; with < 2 && !*sound && !c->given_up;
         with++) {
        uint64_t sum;
        int rc =
            folder_sum(c->f, c->saved->spec.job, &kept, with, &sum, c->err);

        if (rc < 0)
            return rc;
        *sound = sum == u->sum;
        *line = *sound && with;
    }
    return 0;
}

static int
strike(const struct check *c, struct saved_unit *u)
{
    make_new(u);
    return c->given_up ? 0 : c->damaged(c->arg, c->saved, u, c->err);
}

/* The unit that ends where u begins, if it is done. */
static struct saved_unit *
done_above(const struct check *c, const struct saved_unit *u)
{
    const struct partition_area *a = &u->area;

    for (uint32_t i = 0; i < c->saved->nunits; i++) {
        const struct partition_area *b = &c->units[i].area;

        if (c->units[i].done && b->frame == a->frame && b->x == a->x &&
            b->width == a->width && b->y + b->height == a->y)
            return &c->units[i];
    }
    return NULL;
}

/* Make the unit above u new, too, if its last base line was not kept, for u
 * begins there; and so on, upwards.  The line is not kept if the unit above
 * ended after u. */
static int
strike_above(const struct check *c, const struct saved_unit *u)
{
    struct saved_unit *above;
    bool sound, line;
    int rc = 0;

    while (rc == 0 && (above = done_above(c, u)) != NULL) {
        rc = look(c, above, &sound, &line);
        if (rc < 0 || line)
            break;
        rc = strike(c, above);
        u = above;
    }
    return rc;
}

int
rowcheck_job(struct folder *f, const struct saved_job *saved,
             struct saved_unit *units, rowcheck_fn *damaged, void *arg,
             struct rad_error *err)
{
    bool given_up = folder_is_given_up(f, saved->spec.job);
    const struct check c = { f, saved, given_up, units, damaged, arg, err };
    bool sound, line;
    int rc = 0;

    for (uint32_t i = 0; i < saved->nunits && rc == 0; i++) {
        units[i] = saved->units[i];
        if (units[i].stored == 0 ||
            saved->frames[units[i].area.frame].written)
            continue;
        rc = look(&c, &units[i], &sound, &line);
        if (rc == 0 && !sound)
            rc = strike(&c, &units[i]);
    }
    if (!msg_shares_lines(saved->spec.partition))
        return rc; /* there are no base lines */
    for (uint32_t i = 0; i < saved->nunits && rc == 0; i++)
        if (saved->units[i].done && !units[i].done)
            rc = strike_above(&c, &units[i]);
    return rc;
}
