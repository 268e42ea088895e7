/* polytree.c - see polytree.h
 *
 * Ears are cut off the polygon as it is projected along the axis of the
 * normal's largest component.  A corner is an ear if it turns left and no other
 * corner lies strictly inside the triangle of the corner and its neighbours;
 * corners that coincide, as along a seam, do not block each other.  If rounding
 * leaves no ear, the corner with the largest triangle is cut off, so the loop
 * ends for any input.  */
#include "config.h"

#include "light/sample/polytree.h"
#include "base/vec.h"

#include <string.h>

void
rad_triangle_moments(struct rad_moments *m, const double p0[3],
                     const double e1[3], const double e2[3])
{
    double n[3];

    /* p = p0 + s e1 + t e2: var(s) = var(t) = 1/18, cov(s, t) = -1/36 */
    for (int k = 0; k < 3; k++) {
        m->c[k] = p0[k] + (e1[k] + e2[k]) / 3;
        m->a[k] = (e1[k] - e2[k] / 2) / sqrt(18);
        m->b[k] = e2[k] / sqrt(24);
    }
    rad_copy(m->aim, m->c);
    rad_cross(n, e1, e2);
    m->area = sqrt(rad_dot(n, n)) / 2;
}

struct corners {
    const double *v; /* the polygon's points */
    int ax, ay;      /* the projection's axes, right-handed about the normal */
    int *next;       /* ring of the corners that are not cut off yet */
    int *prev;
};

/* Twice the signed area of the projected triangle i, j, k. */
static double
turn(const struct corners *c, int i, int j, int k)
{
    const double *a = c->v + 3 * i, *b = c->v + 3 * j, *d = c->v + 3 * k;

    return (b[c->ax] - a[c->ax]) * (d[c->ay] - a[c->ay]) -
           (b[c->ay] - a[c->ay]) * (d[c->ax] - a[c->ax]);
}

static bool
is_ear(const struct corners *c, int j)
{
    int i = c->prev[j], k = c->next[j];

    if (!(turn(c, i, j, k) > 0))
        return false;
    for (int q = c->next[k]; q != i; q = c->next[q])
        if (turn(c, i, j, q) > 0 && turn(c, j, k, q) > 0 &&
            turn(c, k, i, q) > 0)
            return false;
    return true;
}

/* The next corner to cut, starting the search at `at`. */
static int
find_ear(const struct corners *c, int at)
{
    int j = at, best = at;
    double most = -INFINITY;

    do {
        double area = turn(c, c->prev[j], j, c->next[j]);

        /* a corner whose triangle has no area may always be cut off */
        if (area == 0 || is_ear(c, j))
            return j;
        if (area > most) {
            most = area;
            best = j;
        }
        j = c->next[j];
    } while (j != at);
    return best;
}

/* Make *leaf the triangle of corner j, with its edges at `edge`; false: it has
 * no area. */
static bool
make_leaf(struct rad_polytree *leaf, const struct corners *c, int j,
          struct rad_polytree_edge edge[3])
{
    const double *p0 = c->v + 3 * c->prev[j];
    const double *p1 = c->v + 3 * j, *p2 = c->v + 3 * c->next[j];

    memset(leaf, 0, sizeof *leaf);
    rad_copy(leaf->p0, p0);
    rad_sub(leaf->e1, p1, p0);
    rad_sub(leaf->e2, p2, p0);
    rad_triangle_moments(&leaf->m, leaf->p0, leaf->e1, leaf->e2);
    edge[0] = (struct rad_polytree_edge){ p0, p1 };
    edge[1] = (struct rad_polytree_edge){ p1, p2 };
    edge[2] = (struct rad_polytree_edge){ p2, p0 };
    leaf->edge = edge;
    leaf->nedges = 3;
    return leaf->m.area > 0;
}

/* Cut all ears into leaves, with edges in edges[3 * n]; returns their number,
 * at most n - 2. */
static int
cut_ears(struct corners *c, int n, struct rad_polytree *leaves,
         struct rad_polytree_edge *edges)
{
    int nleaves = 0, at = 0;

    for (int left = n; left >= 3; left--) {
        int j = find_ear(c, at);

        if (make_leaf(&leaves[nleaves], c, j, edges + 3 * nleaves))
            nleaves++;
        c->next[c->prev[j]] = c->next[j];
        c->prev[c->next[j]] = c->prev[j];
        /* skip the neighbour: else the triangles would be a fan of slivers,
         * which are bad to sample */
        at = c->next[c->next[j]];
    }
    return nleaves;
}

/* Set a and b to the Cholesky factors of a covariance of rank two: pivot on the
 * largest variance, then on the largest that remains. */
static void
factor(double a[3], double b[3], double cov[3][3])
{
    memset(a, 0, 3 * sizeof *a);
    memset(b, 0, 3 * sizeof *b);
    for (int step = 0; step < 2; step++) {
        double *axis = step ? b : a;
        int k = 0;

        for (int i = 1; i < 3; i++)
            if (cov[i][i] > cov[k][k])
                k = i;
        if (!(cov[k][k] > 0))
            break;
        for (int i = 0; i < 3; i++)
            axis[i] = cov[i][k] / sqrt(cov[k][k]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                cov[i][j] -= axis[i] * axis[j];
    }
}

/* Moments of two coplanar patches together. */
static void
join_moments(struct rad_moments *m, const struct rad_moments *p,
             const struct rad_moments *q)
{
    double w[2] = { p->area / (p->area + q->area), 0 };
    double cov[3][3], d[3];

    w[1] = 1 - w[0];
    rad_sub(d, p->c, q->c);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            cov[i][j] = w[0] * (p->a[i] * p->a[j] + p->b[i] * p->b[j]) +
                        w[1] * (q->a[i] * q->a[j] + q->b[i] * q->b[j]) +
                        w[0] * w[1] * d[i] * d[j];
    for (int i = 0; i < 3; i++)
        m->c[i] = w[0] * p->c[i] + w[1] * q->c[i];
    m->area = p->area + q->area;
    factor(m->a, m->b, cov);
}

bool
rad_polytree_has(const struct rad_polytree *t, const double p[3],
                 const double normal[3])
{
    double q[3], h[3], s[3];

    if (t->kid[0])
        return rad_polytree_has(t->kid[0], p, normal) ||
               rad_polytree_has(t->kid[1], p, normal);
    rad_sub(q, p, t->p0);
    rad_cross(h, t->e1, q);
    rad_cross(s, q, t->e2);
    double u = rad_dot(h, normal), v = rad_dot(s, normal);

    return u >= 0 && v >= 0 && u + v <= 2 * t->m.area;
}

/* The axis along which the leaves' centres reach farthest. */
static int
widest_axis(const struct rad_polytree *leaves, int n)
{
    double lo[3], hi[3];
    int axis = 0;

    rad_copy(lo, leaves[0].m.c);
    rad_copy(hi, leaves[0].m.c);
    for (int i = 1; i < n; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = fmin(lo[k], leaves[i].m.c[k]);
            hi[k] = fmax(hi[k], leaves[i].m.c[k]);
        }
    for (int k = 1; k < 3; k++)
        if (hi[k] - lo[k] > hi[axis] - lo[axis])
            axis = k;
    return axis;
}

/* Sort leaves by their centres, by insertion: lights have few corners. */
static void
sort_along(struct rad_polytree *leaves, int n, int axis)
{
    for (int i = 1; i < n; i++)
        for (int j = i; j > 0 && leaves[j].m.c[axis] < leaves[j - 1].m.c[axis];
             j--) {
            struct rad_polytree t = leaves[j];

            leaves[j] = leaves[j - 1];
            leaves[j - 1] = t;
        }
}

/* Set the node's outline from those of its kids: an edge that both have, one
 * there and one back, is inside. */
static bool
join_outlines(struct rad_polytree *node, struct rad_arena *arena)
{
    const struct rad_polytree *a = node->kid[0], *b = node->kid[1];
    int n = a->nedges, most = n + b->nedges;
    struct rad_polytree_edge *edge =
        rad_arena_calloc(arena, (size_t)most, sizeof *edge);

    if (!edge)
        return false;
    memcpy(edge, a->edge, (size_t)n * sizeof *edge);
    for (int i = 0; i < b->nedges; i++) {
        const struct rad_polytree_edge *e = &b->edge[i];
        int k = 0;

        while (k < n && !(edge[k].from == e->to && edge[k].to == e->from))
            k++;
        if (k < n)
            edge[k] = edge[--n];
        else
            edge[n++] = *e;
    }
    node->edge = edge;
    node->nedges = n;
    return true;
}

/* Group n leaves under one node, which is taken from *spare.  The node's aim is
 * its centroid if that lies in a triangle, else the largest triangle's.  NULL:
 * out of memory. */
static const struct rad_polytree *
group(struct rad_polytree *leaves, int n, struct rad_polytree **spare,
      const double normal[3], struct rad_arena *arena)
{
    struct rad_polytree *node;
    const struct rad_polytree *big = leaves;

    if (n == 1)
        return leaves;
    sort_along(leaves, n, widest_axis(leaves, n));
    node = (*spare)++;
    memset(node, 0, sizeof *node);
    node->kid[0] = group(leaves, n / 2, spare, normal, arena);
    node->kid[1] = group(leaves + n / 2, n - n / 2, spare, normal, arena);
    if (!node->kid[0] || !node->kid[1] || !join_outlines(node, arena))
        return NULL;
    join_moments(&node->m, &node->kid[0]->m, &node->kid[1]->m);
    for (int i = 0; i < n; i++) {
        if (rad_polytree_has(&leaves[i], node->m.c, normal)) {
            rad_copy(node->m.aim, node->m.c);
            return node;
        }
        if (leaves[i].m.area > big->m.area)
            big = &leaves[i];
    }
    rad_copy(node->m.aim, big->m.c);
    return node;
}

const struct rad_polytree *
rad_polytree_new(const double *v, int n, const double normal[3],
                 struct rad_arena *arena)
{
    struct rad_polytree *nodes, *spare;
    struct rad_polytree_edge *edges;
    struct corners c = { .v = v };
    int k = 0, nleaves;

    nodes = rad_arena_calloc(arena, 2 * (size_t)n, sizeof *nodes);
    edges = rad_arena_calloc(arena, 3 * (size_t)n, sizeof *edges);
    c.next = rad_arena_calloc(arena, (size_t)n, sizeof *c.next);
    c.prev = rad_arena_calloc(arena, (size_t)n, sizeof *c.prev);
    if (!nodes || !edges || !c.next || !c.prev)
        return NULL;
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) > fabs(normal[k]))
            k = i;
    /* a corner that turns counter-clockwise about the normal turns left */
    c.ax = (k + (normal[k] > 0 ? 1 : 2)) % 3;
    c.ay = (k + (normal[k] > 0 ? 2 : 1)) % 3;
    for (int i = 0; i < n; i++) {
        c.next[i] = (i + 1) % n;
        c.prev[i] = (i + n - 1) % n;
    }
    nleaves = cut_ears(&c, n, nodes, edges);
    if (nleaves == 0)
        return nodes; /* no area: a leaf of zeros */
    spare = nodes + nleaves;
    return group(nodes, nleaves, &spare, normal, arena);
}
