/* passplan.c - see passplan.h
 *
 * A first round of few paths makes records with large zones; each further round
 * has several times as many paths, and makes records with smaller zones.
 * Lattices do not ask at every pixel: that would take longer than it saves,
 * since the picture's sampling leaves most pixels out, too. */
#include "config.h"

#include "passes/passplan.h"

#include <assert.h>
#include <string.h>

/* There is one path for so many pixels, within these bounds; fewer for several
 * frames, by the root of their number, since frames show much the same. */
#define PIXELS_A_PATH 64
#define LEAST_PATHS   256
#define MOST_PATHS    65536

/* Paths up to the end of a round over paths up to the end of the round before;
 * tiles of a round, at most; paths of a tile, at least. */
#define ROUND_GROWTH       4
#define TILES              128
#define LEAST_PATHS_A_TILE 64

/* Large pictures have smaller tiles and fewer rounds, since many workers wait
 * at the end of each round. */
#define LARGE_STEP         128 /* large: the coarsest lattice has this step */
#define LARGE_TILES        4096
#define LARGE_ROUND_TILES  512
#define LARGE_PATHS_A_TILE 8
#define LARGE_ROUND_GROWTH 8
#define LARGE_LEAST_PATHS  1024

/* The step of the coarsest lattice [pixels]: COARSE_STEP, or larger in large
 * pictures, up to MOST_STEP, until there are MOST_POINTS along a side.  Points
 * of one pass that lie in each other's zones would make the same records. */
#define COARSE_STEP 32
#define MOST_POINTS 32
#define MOST_STEP   256
/* The coarsest step of frames after the first: earlier frames have shown much
 * of the same scene. */
#define LATER_STEP 16

/* A batch also looks at frames of the next batch that are at least so many
 * frames apart.  Their records would else change, from one picture to the next,
 * what records give that serve both batches. */
#define AHEAD 4

/* If more frames than this are looked at together, their last lattice has twice
 * the step: other frames have asked for small things. */
#define FEW 4

/* Tiles of lattices with at least this step have fewer pixels, so that there
 * are tiles for many workers. */
#define SPARSE_STEP 16
#define SPARSE_SIDE 4

/* A tile ends when it has traced the rays of so many hemispheres: workers wait
 * for the last tile of a pass. */
#define MOST_HEMISPHERES  32
#define LARGE_HEMISPHERES 4

/* For the scattered pass over the places that tiles of the last lattice left
 * out.  Its squares have sides of so many pixels: a part of the picture that
 * takes long has many of them, in different tiles. */
#define REST_PIXELS  16
#define REST_TILES   256 /* of a frame, a part or a round of it, at most */

/* A tile has at least so many squares, unless the pass would then have fewer
 * than REST_FEW tiles. */
#define REST_SQUARES 4
#define REST_FEW     32

/* The squares of the first round: so few that only few tiles make the same deep
 * records. */
#define REST_FIRST 4

/* Frames frame .. beyond - 1; those of the next batch end before `next`. */
struct batch {
    uint32_t frame, beyond, next;
};

static int
lesser(int a, int b)
{
    return a < b ? a : b;
}

static uint32_t
count_paths(const struct rad_pass_size *size, const struct batch *b)
{
    uint64_t pixels = 0, paths;
    uint32_t root = 1;

    while (root * root < b->beyond - b->frame)
        root++;
    for (uint32_t i = b->frame; i < b->beyond; i++)
        pixels += (uint64_t)size[i].width * (uint64_t)size[i].height;
    paths = pixels / (PIXELS_A_PATH * root);
    return paths < LEAST_PATHS  ? LEAST_PATHS
           : paths > MOST_PATHS ? MOST_PATHS
                                : (uint32_t)paths;
}

/* The number of tiles for so many paths. */
static uint32_t
count_tiles(uint32_t paths, bool large)
{
    uint32_t most = large ? LARGE_ROUND_TILES : TILES;
    uint32_t n = paths / (large ? LARGE_PATHS_A_TILE : LEAST_PATHS_A_TILE);

    return n < 1 ? 1 : n > most ? most : n;
}

/* How many rays of hemispheres a tile may trace. */
static uint64_t
most_rays(const struct rad_params *par, bool large)
{
    return (large ? LARGE_HEMISPHERES : MOST_HEMISPHERES) *
           ((uint64_t)par->ambdiv + (uint64_t)par->ambssamp);
}

/* The step of the coarsest lattice of the first frame [pixels]. */
static int
coarsest_step(const struct rad_pass_size *size)
{
    int longest = size->width > size->height ? size->width : size->height;
    int step = COARSE_STEP;

    while (step < MOST_STEP && longest > MOST_POINTS * step)
        step *= 2;
    return step;
}

static bool
is_large(const struct rad_pass_size *size)
{
    return coarsest_step(size) >= LARGE_STEP;
}

/* Does the pass come in parts?  Only those of a large first frame: at the
 * borders of parts some records are made twice, in a small picture too many. */
static bool
in_parts(const struct rad_pass *pass, const struct rad_pass_size *size)
{
    return pass->frame == 0 && is_large(size);
}

/* Plan the pass in which all paths of the batch are walked. */
static void
plan_walks(const struct rad_params *par, const struct rad_pass_size *size,
           const struct batch *b, struct rad_pass *pass)
{
    uint32_t paths = count_paths(size, b);

    *pass = (struct rad_pass){ .walks = rad_pass_deepest(par),
                               .end = paths,
                               .paths = paths,
                               .frame = b->frame,
                               .stride = 1,
                               .beyond = b->beyond,
                               .part = -1,
                               .field = -1,
                               .tiles = count_tiles(
                                   paths, is_large(&size[b->frame])) };
}

/* Plan the tiles of a round, *pass, or the passes of its parts; returns how
 * many passes there are. */
static uint32_t
plan_round(struct rad_pass *pass, const struct rad_pass_size *size)
{
    bool large = is_large(&size[pass->frame]);
    uint32_t tiles = count_tiles(pass->end - pass->first, large);

    pass->tiles = tiles;
    if (!in_parts(pass, size) || tiles < RAD_PASS_PARTS)
        return 1;
    pass->tiles = tiles / RAD_PASS_PARTS;
    for (int i = 0; i < RAD_PASS_PARTS; i++) {
        pass[i] = pass[0];
        pass[i].part = i;
    }
    return RAD_PASS_PARTS;
}

/* Plan the rounds for records of a level.  The last round ends with the last
 * path; each round before it ends with `growth` times fewer.  Batches after the
 * first have one round: earlier batches have made most of the records.
 * Returns the number of passes. */
static uint32_t
plan_level(const struct rad_params *par, int level,
           const struct rad_pass_size *size, const struct batch *b,
           struct rad_pass *pass)
{
    bool large = is_large(&size[b->frame]);
    uint32_t growth = large ? LARGE_ROUND_GROWTH : ROUND_GROWTH;
    uint32_t least = large ? LARGE_LEAST_PATHS : LEAST_PATHS;
    uint32_t paths = count_paths(size, b);
    uint32_t n = 0, first = 0, part = 1;

    while (b->frame == 0 && paths / (part * growth) >= least)
        part *= growth;
    for (; part > 0; part /= growth) {
        uint32_t end = paths / part;

        pass[n] = (struct rad_pass){ .level = level,
                                     .first = first,
                                     .end = end,
                                     .paths = paths,
                                     .frame = b->frame,
                                     .stride = 1,
                                     .beyond = b->beyond,
                                     .part = -1,
                                     .rays = most_rays(par, large) };
        n += plan_round(&pass[n], size);
        first = end;
    }
    return n;
}

/* The step of the last lattice: at most that of base lines (-ps), in bounds. */
static int
finest_step(const struct rad_params *par)
{
    int step = RAD_PASS_FINEST;

    while (step > RAD_PASS_LEAST_STEP && step > par->psample)
        step /= 2;
    return step;
}

/* The side of a tile, in pixels of a lattice with that step. */
static int
side_of(const struct rad_pass_size *size, int step)
{
    struct rad_pass pass = { .step = step, .side = 1, .part = -1 };

    if (!is_large(size))
        return step < SPARSE_STEP ? RAD_PASS_SIDE : SPARSE_SIDE;
    while (pass.side < RAD_PASS_SIDE &&
           rad_pass_tiles(&pass, size->width, size->height) > LARGE_TILES)
        pass.side *= 2;
    return pass.side;
}

static void
count_lattice_tiles(struct rad_pass *pass, const struct rad_pass_size *size)
{
    pass->tiles = 0;
    for (uint32_t i = pass->frame; i < pass->beyond; i += pass->stride)
        pass->tiles += rad_pass_tiles(pass, size[i].width, size[i].height);
}

static uint32_t
greatest_divisor(uint32_t a, uint32_t b)
{
    return b > 0 ? greatest_divisor(b, a % b) : a;
}

/* A number without a divisor in common with n, near the golden section of n:
 * its multiples modulo n are spread about evenly, however many there are. */
static uint32_t
leap_of(uint32_t n)
{
    uint32_t leap = (uint32_t)((uint64_t)n * 618034 / 1000000);

    while (greatest_divisor(n, leap) > 1)
        leap++;
    return leap;
}

/* Set the number of tiles of a scattered pass. */
static void
count_rest_tiles(struct rad_pass *pass)
{
    uint32_t frames = (pass->beyond - 1 - pass->frame) / pass->stride + 1;
    uint32_t squares = pass->end - pass->first, n = squares / REST_SQUARES;

    if (n < REST_FEW)
        n = squares < REST_FEW ? squares : REST_FEW;
    pass->tiles = n < (uint64_t)REST_TILES * frames ? n : REST_TILES * frames;
}

/* Does a scattered pass come in rounds?  Only that of a small first frame: in
 * other frames nearly all records are made before that pass. */
static bool
in_rounds(const struct rad_pass *pass, const struct rad_pass_size *size)
{
    return pass->frame == 0 && !is_large(size);
}

/* Make of *pass, the last lattice, the scattered pass over the places that its
 * tiles left out when they had traced their rays; or the rounds of that pass,
 * each over as many squares as all rounds before it, the last over up to twice
 * as many.  Returns the number of passes. */
static uint32_t
plan_rest(struct rad_pass *pass, const struct rad_pass_size *size)
{
    struct rad_pass all = *pass;
    uint32_t n = 0;

    all.field = -1;
    all.step *= 2;
    all.side = REST_PIXELS / all.step;
    count_lattice_tiles(&all, size);
    all.squares = all.end = all.tiles;
    all.leap = leap_of(all.squares);
    for (uint32_t first = 0; first < all.squares; first = pass[n++].end) {
        uint32_t some = first > 0 ? first : REST_FIRST;

        pass[n] = all;
        pass[n].first = first;
        if (in_rounds(&all, size) && all.squares - first > 2 * some)
            pass[n].end = first + some;
        count_rest_tiles(&pass[n]);
    }
    return n;
}

/* Plan pass *k over pixels, or the passes of its parts or rounds.  Passes
 * without tiles are left out: a single tile has one colour, and is in one part.
 * Returns the number of passes. */
static uint32_t
plan_lattice(const struct rad_pass *k, const struct rad_pass_size *size,
             struct rad_pass *pass)
{
    int parts = in_parts(k, size) ? RAD_PASS_PARTS : 0;
    uint32_t n = 0;

    for (int part = parts ? 0 : -1; part < parts; part++) {
        pass[n] = *k;
        pass[n].part = part;
        if (k->scattered) {
            n += plan_rest(&pass[n], size);
            continue;
        }
        count_lattice_tiles(&pass[n], size);
        n += pass[n].tiles > 0;
    }
    return n;
}

/* Plan the lattices of frames frame, frame + stride, ... below beyond; returns
 * the number of passes. */
static uint32_t
plan_frames(const struct rad_params *par, const struct rad_pass_size *size,
            uint32_t frame, uint32_t stride, uint32_t beyond,
            struct rad_pass *pass)
{
    const struct rad_pass_size *of = &size[frame];
    bool many = beyond - frame > FEW * stride;
    int finest = finest_step(par) * (many ? 2 : 1), done = 0;
    int step = frame == 0 ? coarsest_step(of) : LATER_STEP;
    struct rad_pass rest;
    uint32_t n = 0;

    for (; step >= finest; done = step, step /= 2) {
        struct rad_pass k = { .step = step,
                              .done = done,
                              .frame = frame,
                              .stride = stride,
                              .beyond = beyond,
                              .side = lesser(side_of(of, step),
                                             RAD_PASS_PIXELS / finest),
                              .finest = step == finest,
                              .rays = most_rays(par, is_large(of)) };
        bool fields = frame == 0 && (done > 0 || is_large(of));

        for (k.field = fields ? 0 : -1; k.field < 2 * fields; k.field++)
            n += plan_lattice(&k, size, pass + n);
    }
    rest = pass[n - 1];
    rest.scattered = true;
    if (in_parts(&rest, size))
        n += plan_lattice(&rest, size, pass + n);
    rest.rays = 0;
    return n + plan_lattice(&rest, size, pass + n);
}

/* Plan the lattices of frames at odd multiples of ever smaller distances from
 * the job's first frame, or from the last frame of the batch before: distances
 * from AHEAD on, or shorter ones.  Returns the number of passes. */
static uint32_t
plan_between(const struct rad_params *par, const struct rad_pass_size *size,
             uint32_t frame, uint32_t beyond, bool far, struct rad_pass *pass)
{
    uint32_t from = frame > 0 ? frame - 1 : 0, apart = 1, n = 0;

    while (apart < beyond - from)
        apart *= 2;
    while ((apart /= 2) > 0)
        if ((apart >= AHEAD) == far)
            n += plan_frames(par, size, from + apart, 2 * apart, beyond,
                             pass + n);
    return n;
}

/* Plan the lattices of a batch: of the next batch's frames far apart, and of
 * its own frames between those that the batch before has looked at.  The first
 * batch begins with the job's first frame and its own frames far apart. Returns
 * the number of passes. */
static uint32_t
plan_pixels(const struct rad_params *par, const struct rad_pass_size *size,
            const struct batch *b, struct rad_pass *pass)
{
    uint32_t n = 0;

    if (b->frame == 0) {
        n = plan_frames(par, size, 0, 1, 1, pass);
        n += plan_between(par, size, 0, b->beyond, true, pass + n);
    }
    if (b->next > b->beyond)
        n += plan_between(par, size, b->beyond, b->next, true, pass + n);
    return n + plan_between(par, size, b->frame, b->beyond, false, pass + n);
}

static uint32_t
plan_batch(const struct rad_params *par, const struct rad_pass_size *size,
           const struct batch *b, struct rad_pass *pass)
{
    uint32_t n = 0;

    if (rad_pass_deepest(par) > 0)
        plan_walks(par, size, b, &pass[n++]);
    for (int level = rad_pass_deepest(par); level > 0; level--)
        n += plan_level(par, level, size, b, pass + n);
    n += plan_pixels(par, size, b, pass + n);
    for (uint32_t i = 0; i < n; i++)
        pass[i].ready = i + 1 < n ? b->frame : b->beyond;
    return n;
}

/* The number of fields, squares of that side, along a length [pixels]. */
static uint32_t
along(int length, int side)
{
    return ((uint32_t)length + (uint32_t)side - 1) / (uint32_t)side;
}

/* The number of fields of one colour in the first row; those of the first two
 * rows together are as many as a row has fields. */
static uint32_t
in_first_row(uint32_t across, int field)
{
    return (across + (field == 0)) / 2;
}

/* The fields of a pass in a frame: `columns` of them from `column` on, in each
 * of `rows` rows from `row` on. */
struct fields {
    uint32_t column, columns, row, rows;
};

/* The field at which a part of the length begins. */
static uint32_t
border(int part, int length, int side)
{
    return part < RAD_PASS_PARTS
               ? (uint32_t)((int64_t)length * part / RAD_PASS_PARTS +
                            side / 2) /
                     (uint32_t)side
               : along(length, side);
}

/* The fields along a length that belong to a part: *n from *first on. */
static void
cut(int part, int length, int side, uint32_t *first, uint32_t *n)
{
    *first = border(part, length, side);
    *n = border(part + 1, length, side) - *first;
}

static struct fields
fields_of(const struct rad_pass *pass, int width, int height)
{
    int side = pass->side * pass->step;
    struct fields f = { 0, along(width, side), 0, along(height, side) };

    if (pass->part >= 0 && width >= height)
        cut(pass->part, width, side, &f.column, &f.columns);
    else if (pass->part >= 0)
        cut(pass->part, height, side, &f.row, &f.rows);
    return f;
}

uint32_t
rad_pass_tiles(const struct rad_pass *pass, int width, int height)
{
    struct fields f = fields_of(pass, width, height);

    if (pass->field < 0)
        return f.columns * f.rows;
    return f.rows / 2 * f.columns +
           (f.rows % 2 ? in_first_row(f.columns, pass->field) : 0);
}

struct rad_pass_area
rad_pass_area(const struct rad_pass *pass, int width, int height,
              uint32_t square)
{
    int side = pass->side * pass->step, x, y;
    struct fields f = fields_of(pass, width, height);
    uint32_t row = square / f.columns, column = square % f.columns;

    if (pass->field >= 0) {
        uint32_t first = in_first_row(f.columns, pass->field);
        bool second = column >= first;

        row = 2 * row + second;
        column = second ? 2 * (column - first) + !pass->field
                        : 2 * column + (uint32_t)pass->field;
    }
    x = (int)(f.column + column) * side;
    y = (int)(f.row + row) * side;
    return (struct rad_pass_area){ x, y, lesser(x + side, width),
                                   lesser(y + side, height) };
}

/* Things 0 to all - 1 are shared out in equal runs among the tiles of a pass;
 * returns the first thing of this tile. */
static uint32_t
run_begin(const struct rad_pass *pass, uint32_t all, uint32_t tile)
{
    return (uint32_t)((uint64_t)all * tile / pass->tiles);
}

uint32_t
rad_pass_squares(const struct rad_pass *pass, uint32_t tile)
{
    uint32_t all = pass->end - pass->first;

    return pass->scattered
               ? run_begin(pass, all, tile + 1) - run_begin(pass, all, tile)
               : 1;
}

uint32_t
rad_pass_square(const struct rad_pass *pass, uint32_t tile, uint32_t i)
{
    uint32_t at = pass->first + i;

    if (!pass->scattered)
        return tile;
    at += run_begin(pass, pass->end - pass->first, tile);
    return (uint32_t)((uint64_t)at * pass->leap % pass->squares);
}

uint32_t
rad_pass_paths(const struct rad_pass *pass, uint32_t tile, uint32_t *first)
{
    *first = run_begin(pass, pass->paths, tile);
    return run_begin(pass, pass->paths, tile + 1) - *first;
}

int
rad_pass_deepest(const struct rad_params *par)
{
    return lesser(par->ambounce - 1, RAD_PASS_LEVELS);
}

/* May `pass` go without the records of the pass `before`?  Yes, if they are
 * different parts; but a lattice needs all parts of the rounds of paths.  And
 * yes, if `before` walks for a later batch: such a pass is closed only when the
 * pictures of the batch before are made. */
static bool
is_apart(const struct rad_pass *pass, const struct rad_pass *before)
{
    if (before->walks)
        return pass->frame > 0;
    return pass->part >= 0 && before->part >= 0 && pass->part != before->part &&
           (pass->level > 0 || before->level == 0);
}

/* How many passes pass i reads: all before it but the last few that are apart.
 */
static uint32_t
reads(const struct rad_pass *pass, uint32_t i)
{
    uint32_t n = i;

    while (n > 0 && i - n < RAD_PASS_PARTS - 1 &&
           is_apart(&pass[i], &pass[n - 1]))
        n--;
    return n;
}

/* The end of the frames of the first i batches. */
static uint32_t
frames_end(uint32_t nframes, uint32_t i, uint32_t batches)
{
    return (uint32_t)((uint64_t)nframes * i / batches);
}

uint32_t
rad_passes_plan(const struct rad_params *par, const struct rad_pass_size *size,
                uint32_t nsizes, struct rad_pass pass[RAD_MOST_PASSES])
{
    uint32_t batches = (nsizes - 1) / RAD_PASS_BATCH + 1, n = 0;
    struct batch b = { 0 };
    int round = 0;

    if (par->ambounce < 1 || !(par->ambacc > 0) || par->ambdiv < 1)
        return 0;
    if (batches > RAD_PASS_BATCHES)
        batches = RAD_PASS_BATCHES;
    for (uint32_t i = 1; i <= batches; i++, b.frame = b.beyond) {
        b.beyond = frames_end(nsizes, i, batches);
        b.next = i < batches ? frames_end(nsizes, i + 1, batches) : nsizes;
        n += plan_batch(par, size, &b, pass + n);
    }
    for (uint32_t i = 0; i < n; i++) {
        round ^= pass[i].level > 0 && pass[i].part <= 0;
        pass[i].round = round;
        pass[i].reads = reads(pass, i);
    }
    return n;
}

/* RAD_MOST_PASSES leaves room for one more pass.  The first batch has 5 rounds
 * of paths (or 3, in 4 parts each) for each of 8 levels, each of the 31 other
 * batches has 1 for each, and each batch has a pass that walks.  The first
 * frame has 72 passes, a small one with its rounds 24 at most, and each batch,
 * of up to 2048 of 65536 frames, has 12 times 5 more. */
uint32_t
rad_passes_plan_on(const struct rad_params *par,
                   const struct rad_pass_size *size, uint32_t nsizes,
                   struct rad_pass pass[RAD_MOST_PASSES])
{
    uint32_t n = rad_passes_plan(par, size, nsizes, pass);

    if (n == 0)
        return 0;
    assert(n < RAD_MOST_PASSES);
    memmove(pass + 1, pass, n * sizeof *pass);
    pass[0] = (struct rad_pass){ .tiles = 0 };
    for (uint32_t i = 1; i <= n; i++)
        pass[i].reads++;
    return n + 1;
}
