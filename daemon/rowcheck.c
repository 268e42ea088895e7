/* rowcheck.c - see rowcheck.h */
#include "config.h"

#include "rowcheck.h"

/* Nobody had it, so rows of that attempt that are still to come are late. */
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

/* Where each pixel is traced a base line that was kept leaves no densities:
 * then the sum alone says whether there is one. */
static int
look(struct folder *f, const struct saved_job *saved,
     const struct saved_unit *u, bool *sound, struct rad_error *err)
{
    *sound = false;
    for (int line = u->nbottom > 0; line < 2 && !*sound; line++) {
        uint64_t sum;
        int rc = folder_sum(f, saved->spec.job, &u->area, u->stored, line, &sum,
                            err);

        if (rc < 0)
            return rc;
        *sound = sum == u->sum;
    }
    return 0;
}

int
rowcheck_job(struct folder *f, const struct saved_job *saved,
             struct saved_unit *units,
             int (*damaged)(void *arg, const struct saved_job *saved,
                            const struct saved_unit *unit,
                            struct rad_error *err),
             void *arg, struct rad_error *err)
{
    int rc = 0;

    for (uint32_t i = 0; i < saved->nunits && rc == 0; i++) {
        struct saved_unit *u = &units[i];
        bool sound;

        *u = saved->units[i];
        if (u->stored == 0 || saved->written[u->area.frame])
            continue;
        rc = look(f, saved, u, &sound, err);
        if (rc < 0 || sound)
            continue;
        make_new(u);
        rc = damaged(arg, saved, u, err);
    }
    return rc;
}
