/* idle.c - see idle.h */
#include "config.h"

#include "radd/idle.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

double
idle_used(const char *stat, long ticks)
{
    unsigned long long user, nice, system;

    if (sscanf(stat, "cpu %llu %llu %llu", &user, &nice, &system) != 3)
        return -1;
    return (double)(user + system) / (double)ticks;
}

bool
idle_judge(struct idle *i, uint64_t now_ms, double used_s, double terminal_s)
{
    double ms = (double)(now_ms - i->looked_ms);
    uint64_t ago;

    if (i->looked_ms != 0 && i->used_s >= 0 && used_s >= 0 &&
        (used_s - i->used_s) * 1000 > IDLE_LOAD * ms)
        i->last_ms = now_ms;
    if (terminal_s < IDLE_QUIET_S) {
        ago = (uint64_t)(1000 * terminal_s);
        ago = now_ms > ago ? now_ms - ago : 1;
        if (ago > i->last_ms)
            i->last_ms = ago;
    }
    i->looked_ms = now_ms;
    i->used_s = used_s;
    return i->last_ms != 0 && now_ms - i->last_ms < 1000 * IDLE_QUIET_S;
}

/* Seconds since a terminal in the folder, whose name is prefix and digits, was
 * last used; INFINITY: there is none. */
static double
since_used(const char *dir, const char *prefix, time_t now)
{
    DIR *d = opendir(dir);
    struct dirent *e;
    double least = INFINITY;

    while (d && (e = readdir(d)) != NULL) {
        const char *rest = e->d_name + strlen(prefix);
        struct stat st;
        double s;

        /* such as pts/3 or tty2; not console, ptmx or ttyS0 */
        if (strncmp(e->d_name, prefix, strlen(prefix)) != 0 || *rest < '0' ||
            *rest > '9' || fstatat(dirfd(d), e->d_name, &st, 0) < 0 ||
            !S_ISCHR(st.st_mode))
            continue;
        s = difftime(now,
                     st.st_atime > st.st_mtime ? st.st_atime : st.st_mtime);
        if (s < least)
            least = s > 0 ? s : 0;
    }
    if (d)
        closedir(d);
    return least;
}

bool
idle_look(struct idle *i, uint64_t now_ms)
{
    char stat[256] = "";
    FILE *f = fopen("/proc/stat", "re");
    time_t now = time(NULL);
    double pts = since_used("/dev/pts", "", now);
    double tty = since_used("/dev", "tty", now);

    if (f && !fgets(stat, sizeof stat, f))
        stat[0] = '\0';
    if (f)
        fclose(f);
    return idle_judge(i, now_ms, idle_used(stat, sysconf(_SC_CLK_TCK)),
                      pts < tty ? pts : tty);
}
