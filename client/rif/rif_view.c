/* rif_view.c - see rif_view.h */
#include "config.h"

#include "rif/rif_view.h"

#include "base/number.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* UP: 1, 2, 3 for X, Y, Z, negative: downwards; 0: not given. */
static int
up_axis(const struct rif *r, int *axis, struct rad_error *err)
{
    const char *text = r->last[RIF_UP] ? r->last[RIF_UP]->text : NULL;
    bool sign = text && (*text == '-' || *text == '+');
    int c = text ? toupper((unsigned char)text[sign]) : 'X' - 1;

    *axis = c - 'X' + 1;
    if (*axis < (text ? 1 : 0) || *axis > 3)
        return rif_fail(r, RIF_UP, err, "expected X, Y or Z, or -X, -Y, -Z");
    if (sign && *text == '-')
        *axis = -*axis;
    return 0;
}

struct standard {
    int side[3]; /* of the zone's middle on which the eye is, along each axis:
                  * 1, -1 or 0 */
    char type;   /* the projection */
};

/* Parse the name of a standard view, such as "X", "xYz" or "Zl". */
static bool
is_standard(const char *name, size_t len, struct standard *s)
{
    size_t at = 0;
    bool any = false;

    *s = (struct standard){ .type = 'v' };
    for (int i = 0; i < 3; i++)
        if (at < len && toupper((unsigned char)name[at]) == 'X' + i) {
            s->side[i] = name[at++] == 'X' + i ? 1 : -1;
            any = true;
        }
    if (at < len && strchr("vlahsc", name[at]))
        s->type = name[at++];
    return any && at == len;
}

/* The up axis of a standard view; another than `axis` if the view looks along
 * that. */
static int
turned_up(int axis, const int side[3])
{
    switch (abs(axis)) {
    case 0:
    case 3:
        return side[0] || side[1] ? axis : 2;
    case 2:
        return side[0] || side[2] ? axis : 1;
    default:
        return side[1] || side[2] ? axis : 3;
    }
}

static const char *
up_option(int axis)
{
    static const char *const vup[] = { "-vu 0 0 -1", "-vu 0 -1 0", "-vu -1 0 0",
                                       "-vu 0 0 1",  "-vu 1 0 0",  "-vu 0 1 0",
                                       "-vu 0 0 1" };

    return vup[axis + 3];
}

/* The angles of a standard view; for a parallel one, its width, the zone's
 * diagonal. */
static void
angles(char type, const double size[3], char *text, size_t room)
{
    double across =
        sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]);

    if (type == 'v')
        snprintf(text, room, "-vh 45 -vv 45");
    else if (type == 'l')
        snprintf(text, room, "-vh %.3g -vv %.3g", across, across);
    else
        snprintf(text, room, "-vh 180 -vv %s", type == 'c' ? "90" : "180");
}

/* Write the options of a standard view, followed by `more`. */
static void
standard_text(const struct rif_zone *z, const struct standard *s, int up,
              const char *more, char *text, size_t room)
{
    double away = z->interior ? .45 : 2, vp[3], vd[3];
    char size[80];

    for (int i = 0; i < 3; i++) {
        vp[i] = z->org[i] + z->size[i] * (.5 + s->side[i] * away);
        vd[i] = -s->side[i] * z->size[i];
    }
    angles(s->type, z->size, size, sizeof size);
    snprintf(text, room, "-vt%c -vp %.3g %.3g %.3g -vd %.3g %.3g %.3g %s %s %s",
             s->type, vp[0], vp[1], vp[2], vd[0], vd[1], vd[2],
             up_option(turned_up(up, s->side)), size, more);
}

/* Set the view's options.  RAD_EDATA: the text is only a name, and not that of
 * a standard view, or has a second word that is no option. */
static int
set_words(struct rif *r, const struct rif_zone *z, struct rif_view *v,
          const char *text, struct rad_error *err)
{
    size_t len = strcspn(text, " \t\n"), room = strlen(text) + 400;
    const char *more = text + len + strspn(text + len, " \t\n");
    char *buf = rad_arena_alloc(&r->arena, room);
    struct standard s;
    int up, rc = up_axis(r, &up, err);

    if (rc < 0)
        return rc;
    if (!buf)
        return rad_fail_memory(err);
    if (text[0] != '-' && !strchr("-@'\"", *more))
        return rad_fail(err, RAD_EDATA,
                        "view '%.*s': '%.40s' is no option, and a view's name "
                        "is one word",
                        (int)(len < 40 ? len : 40), text, more);
    if (text[0] == '-')
        snprintf(buf, room, "%s", text);
    else if (is_standard(text, len, &s))
        standard_text(z, &s, up, more, buf, room);
    else if (*more)
        snprintf(buf, room, "%s %s", up ? up_option(up) : "", more);
    else
        return rad_fail(err, RAD_EDATA,
                        "view '%.60s' has no options, and is none of rad's "
                        "standard views",
                        text);
    v->nwords = rif_split(r, buf, &v->words, err);
    return v->nwords < 0 ? v->nwords : 0;
}

/* Take the n-th view of the file, from 1. */
static int
take(struct rif *r, const struct rif_zone *z, const struct rif_value *value,
     int n, struct rif_view *v, struct rad_error *err)
{
    const char *text = value->text;
    char number[16];
    int rc;

    snprintf(number, sizeof number, "%d", n);
    v->number = n;
    v->line = value->line;
    v->name = text[0] == '-'
                  ? rad_arena_strndup(&r->arena, number, strlen(number))
                  : rad_arena_strndup(&r->arena, text, strcspn(text, " \t\n"));
    rc = v->name ? set_words(r, z, v, text, err) : rad_fail_memory(err);
    if (rc < 0 && value->line > 0)
        rad_error_where(err, "%s:%d", r->name, value->line);
    return rc;
}

/* Check that no two views have the same name, for their pictures would have,
 * too. */
static int
check_names(const struct rif *r, const struct rif_view *list, int n,
            struct rad_error *err)
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < i; k++)
            if (strcmp(list[i].name, list[k].name) == 0) {
                rad_error_where(err, "%s:%d", r->name, list[i].line);
                return rad_fail(err, RAD_EDATA,
                                "view '%.60s' is there twice: its pictures "
                                "would have one name",
                                list[i].name);
            }
    return 0;
}

static bool
is_named(const struct rif_value *value, const char *name)
{
    size_t n = strlen(name);

    return strncmp(value->text, name, n) == 0 &&
           (value->text[n] == '\0' || isspace((unsigned char)value->text[n]));
}

/* List the names of the file's views, "a, b, c", as many as fit. */
static void
list_names(const struct rif *r, char *text, size_t room)
{
    size_t at = 0;
    int n = 1;

    text[0] = '\0';
    for (const struct rif_value *i = r->first[RIF_VIEW]; i; i = i->next, n++) {
        size_t len = strcspn(i->text, " \t\n");
        const char *comma = n > 1 ? ", " : "";

        if (at + len + sizeof ", 65536, ..." > room) {
            snprintf(text + at, room - at, "%s...", comma);
            return;
        }
        if (i->text[0] == '-')
            at += (size_t)snprintf(text + at, room - at, "%s%d", comma, n);
        else
            at += (size_t)snprintf(text + at, room - at, "%s%.*s", comma,
                                   (int)len, i->text);
    }
}

/* Fail if `which` is only a name, and neither that of a view of the file's nor
 * that of a standard view. */
static int
unknown(const struct rif *r, const char *which, struct rad_error *why)
{
    char names[120];
    struct standard s;

    if (which[0] == '-' || which[strcspn(which, " \t\n")] ||
        is_standard(which, strlen(which), &s))
        return 0;
    list_names(r, names, sizeof names);
    return rad_fail(
        why, RAD_EDATA,
        "none of the file's views (%s), nor of rad's standard views",
        names[0] ? names : "it names none");
}

/* Find the view that --view asks for, in the file or not. */
static int
choose(struct rif *r, const struct rif_zone *z, const char *which,
       struct rif_view *v, struct rad_error *err)
{
    struct rad_error why = { 0 };
    int number = 0, n = 1, rc;

    if (!rad_parse_int(which, &number))
        number = -1;
    for (const struct rif_value *i = r->first[RIF_VIEW]; i; i = i->next, n++)
        if (number >= 0 ? n == number : is_named(i, which)) {
            rc = take(r, z, i, n, v, err);
            if (!r->first[RIF_VIEW]->next)
                v->number = 0;
            return rc;
        }
    v->name = which[0] == '-' ? "0" : which;
    if (number >= 0)
        rc = rad_fail(&why, RAD_EDATA, "%d view%s there", n - 1,
                      n == 2 ? " is" : "s are");
    else if ((rc = unknown(r, which, &why)) == 0)
        rc = set_words(r, z, v, which, &why);
    if (rc == RAD_EDATA)
        return rad_fail(err, RAD_EUSAGE, "option '--view': '%.60s': %s", which,
                        why.what);
    return rc < 0 ? rad_fail(err, rc, "%s", why.what) : 0;
}

int
rif_views(struct rif *r, const struct rif_zone *z, const char *which,
          struct rif_view **list, struct rad_error *err)
{
    static const struct rif_value from_x = { .text = "X" }; /* by default */
    const struct rif_value *value =
        r->first[RIF_VIEW] ? r->first[RIF_VIEW] : &from_x;
    int n = 0, rc = 0;

    *list = rad_arena_calloc(&r->arena, (size_t)r->nvalues + 1, sizeof **list);
    if (!*list)
        return rad_fail_memory(err);
    if (which) {
        rc = choose(r, z, which, *list, err);
        return rc < 0 ? rc : 1;
    }
    for (; value && rc == 0; value = value->next) {
        rc = take(r, z, value, n + 1, &(*list)[n], err);
        n++;
    }
    if (n == 1)
        (*list)->number = 0; /* not numbered: a single picture */
    if (rc == 0)
        rc = check_names(r, *list, n, err);
    return rc < 0 ? rc : n;
}
