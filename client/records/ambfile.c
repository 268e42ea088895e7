/* ambfile.c - see ambfile.h */
#include "config.h"

#include "records/ambfile.h"
#include "proto/ambshare.h"
#include "base/files.h"
#include "base/vec.h"
#include "base/output.h"
#include "image/hdr.h"
#include "scene/meshfile.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define OUR_FORMAT     "radd_ambient_3"
#define RADIANCE       "Radiance_ambval"
#define RADIANCE_MAGIC 0x0231
#define RADIANCE_BYTES 67
#define DIRECTION_UNIT 11584.5
#define LARGEST_FILE   (SIZE_MAX / 4)

/* --- options --- */

/* The options that records depend on, as text.  Left out are the seed, for
 * records of any seed serve, and whether the eye sees light sources. */
static void
options_text(const struct ambfile *a, char text[RAD_PARAMS_TEXT])
{
    struct rad_params p;

    rad_params_of_records(&a->params, &p);
    p.directvis = true;
    p.seed = 0;
    rad_params_format(&p, text, RAD_PARAMS_TEXT);
}

/* Our value of an option, as Radiance prints it in a file's header; false:
 * records do not depend on the option, or it is unknown. */
static bool
radiance_value(const struct rad_params *p, const char *name, char value[96])
{
    const struct {
        const char *name;
        double value;
    } real[] = { { "-ds", p->srcsizerat }, { "-dt", p->shadthresh },
                 { "-dc", p->shadcert },   { "-ss", p->specjitter },
                 { "-st", p->specthresh }, { "-lw", p->minweight } };
    const struct {
        const char *name;
        int value;
    } whole[] = { { "-ab", p->ambounce },    { "-ad", p->ambdiv },
                  { "-as", p->ambssamp },    { "-ar", p->ambres },
                  { "-dr", p->directrelay }, { "-lr", p->maxdepth } };

    for (size_t i = 0; i < sizeof real / sizeof *real; i++)
        if (strcmp(name, real[i].name) == 0) {
            snprintf(value, 96, "%g", real[i].value);
            return true;
        }
    for (size_t i = 0; i < sizeof whole / sizeof *whole; i++)
        if (strcmp(name, whole[i].name) == 0) {
            snprintf(value, 96, "%d", whole[i].value);
            return true;
        }
    return false;
}

/* Compare the options in a line of a Radiance file's header with ours. */
static int
check_line(const struct ambfile *a, char *line, struct rad_error *err)
{
    char *save = NULL, *word, *next;

    for (word = strtok_r(line, " ", &save); word; word = next) {
        char value[96];

        next = strtok_r(NULL, " ", &save);
        if (!next || !radiance_value(&a->params, word, value))
            continue;
        if (strcmp(next, value) != 0)
            return rad_fail(err, RAD_EDATA, "was made with %s %.40s, not %s",
                            word, next, value);
    }
    return 0;
}

/* --- headers --- */

struct header {
    char *format, *scene, *options; /* values; NULL: missing */
    char *text;                     /* the values' memory */
    size_t len;                     /* of the header in the file, with its empty
                                     * line */
};

static int
bad_file(struct rad_error *err)
{
    return rad_fail(err, RAD_EDATA, "not a file of ambient records");
}

/* Copy the header, which ends with an empty line. */
static int
copy_header(struct header *h, const char *bytes, size_t len,
            struct rad_error *err)
{
    size_t n = 0;

    while (n + 1 < len && n < 65536 && bytes[n] != '\0' &&
           !(bytes[n] == '\n' && bytes[n + 1] == '\n'))
        n++;
    if (n + 1 >= len || bytes[n] != '\n' || bytes[n + 1] != '\n' || n < 10 ||
        memcmp(bytes, "#?RADIANCE", 10) != 0)
        return bad_file(err);
    h->text = malloc(n + 1);
    if (!h->text)
        return rad_fail_memory(err);
    memcpy(h->text, bytes, n);
    h->text[n] = '\0';
    h->len = n + 2;
    return 0;
}

static char *
value_of(char *line, const char *name)
{
    size_t n = strlen(name);

    return strncmp(line, name, n) == 0 ? line + n : NULL;
}

/* Read the header's values.  In Radiance's files other lines may have options,
 * which are compared; our files have all of them in OPTIONS. */
static int
read_header(const struct ambfile *a, struct header *h, struct rad_error *err)
{
    bool ours = strstr(h->text, "\nFORMAT=" OUR_FORMAT) != NULL;
    char *save = NULL;

    for (char *line = strtok_r(h->text, "\n", &save); line;
         line = strtok_r(NULL, "\n", &save)) {
        char *v;

        if ((v = value_of(line, "FORMAT=")))
            h->format = v;
        else if ((v = value_of(line, "SCENE=")))
            h->scene = v;
        else if ((v = value_of(line, "OPTIONS=")))
            h->options = v;
        else if ((v = value_of(line, "NCOMP=")) && strcmp(v, "3") != 0)
            return rad_fail(err, RAD_EDATA, "has %.20s channels, not 3", v);
        else if (!ours && check_line(a, line, err) < 0)
            return err ? err->code : RAD_EDATA;
    }
    return 0;
}

static int
fits(struct ambfile *a, const struct header *h, struct rad_error *err)
{
    char options[RAD_PARAMS_TEXT];
    const char *name;
    int n;

    if (h->format && strcmp(h->format, RADIANCE) == 0) {
        a->format = AMBFILE_RADIANCE;
        return 0;
    }
    if (!h->format || strcmp(h->format, OUR_FORMAT) != 0 || !h->scene ||
        !h->options)
        return bad_file(err);
    a->format = AMBFILE_OURS;
    if (strcmp(h->scene, a->scene) != 0)
        return rad_fail(err, RAD_EDATA, "belongs to another scene");
    options_text(a, options);
    if (strcmp(h->options, options) == 0)
        return 0;
    name = rad_params_differ(h->options, options, &n);
    return rad_fail(err, RAD_EDATA, "was made with other options: %.*s differs",
                    n, name);
}

/* --- Radiance's records --- */

/* Write a number, which must be finite. */
static void
put_flt(struct wire_out *out, double v)
{
    int e, m = (int)(frexp(v, &e) * 0x7fffffff);

    if (e < -128 || m == 0)
        m = e = 0;
    wire_put_i32(out, m);
    wire_put_u8(out, (uint8_t)(e > 127 ? 127 : e));
}

static double
get_flt(struct wire_in *in)
{
    int32_t m = wire_get_i32(in);
    int8_t e = (int8_t)wire_get_u8(in);

    if (m == 0)
        return 0;
    return ldexp((m + (m > 0 ? .5 : -.5)) / 0x7fffffff, e);
}

/* As rad_mesh_normal() reads it. */
static void
put_direction(struct wire_out *out, const float v[3])
{
    uint32_t code = 0, c[3];

    for (int k = 0; k < 3; k++) {
        c[k] = (uint32_t)(fabs((double)v[k]) * DIRECTION_UNIT + .5);
        code |= (uint32_t)(v[k] < 0) << k;
    }
    bool x_first = c[0] <= c[1];
    uint32_t first = x_first ? c[0] : c[1], other = x_first ? c[1] : c[0];
    bool z_second = c[2] <= other;
    uint32_t second = z_second ? c[2] : other;

    code |= (uint32_t)x_first << 3 | (uint32_t)z_second << 4 | first << 5 |
            second << 18;
    wire_put_u32(out, code);
}

static void
put_record(struct wire_out *out, const struct rad_ambrec *rec)
{
    uint8_t rgbe[4];

    wire_put_u8(out, (uint8_t)rec->level);
    put_flt(out, (double)rec->weight);
    for (int k = 0; k < 3; k++)
        put_flt(out, rec->p[k]);
    put_direction(out, rec->n);
    put_direction(out, rec->u);
    for (int k = 0; k < 2; k++)
        put_flt(out, (double)rec->radius[k]);
    for (int k = 0; k < 2; k++)
        put_flt(out, (double)rec->gpos[k]);
    for (int k = 0; k < 2; k++)
        put_flt(out, (double)rec->gdir[k]);
    wire_put_u32(out, rec->corral);
    rad_rgbe(rad_rgb_scale(rec->E, (float)(1 / M_PI)), rgbe);
    wire_put_bytes(out, rgbe, sizeof rgbe);
}

/* Set normal and direction u.  In the file both are rounded to 1e-4, so u is
 * made perpendicular to n again. */
static void
set_frame(struct rad_ambrec *rec, const double n[3], double u[3])
{
    rad_madd(u, u, -rad_dot(u, n), n);
    rad_normalize(u);
    for (int k = 0; k < 3; k++) {
        rec->n[k] = (float)n[k];
        rec->u[k] = (float)u[k];
    }
}

static void
get_pair(struct wire_in *in, float v[2])
{
    v[0] = (float)get_flt(in);
    v[1] = (float)get_flt(in);
}

static void
get_record(struct wire_in *in, struct rad_ambrec *rec)
{
    double n[3], u[3];
    uint8_t rgbe[4] = { 0 };

    rec->level = wire_get_u8(in);
    rec->var = RAD_AMBREC_UNSURE;
    rec->weight = (float)get_flt(in);
    for (int k = 0; k < 3; k++)
        rec->p[k] = get_flt(in);
    rad_mesh_normal(n, wire_get_u32(in));
    rad_mesh_normal(u, wire_get_u32(in));
    rad_normalize(n);
    set_frame(rec, n, u);
    get_pair(in, rec->radius);
    get_pair(in, rec->gpos);
    get_pair(in, rec->gdir);
    rec->corral = wire_get_u32(in);
    wire_get_bytes(in, rgbe, sizeof rgbe, sizeof rgbe);
    rec->E = rad_rgb_scale(rad_rgbe_radiance(rgbe), (float)M_PI);
}

/* --- reading --- */

static int
parse_records(const struct ambfile *a, struct wire_in *in,
              struct wire_out *list, struct rad_error *err)
{
    bool ours = a->format == AMBFILE_OURS;
    size_t size = ours ? AMBSHARE_BYTES : RADIANCE_BYTES;

    if (!ours && wire_get_u16(in) != RADIANCE_MAGIC)
        return bad_file(err);
    if (wire_left(in) % size != 0)
        return rad_fail(err, RAD_EDATA, "ends in the middle of a record");
    while (wire_left(in) > 0) {
        struct rad_ambrec rec = { .level = 0 };

        if (!ours)
            get_record(in, &rec);
        if (ours ? ambshare_unpack(in, &rec) : ambshare_sound(&rec))
            ambshare_pack(list, &rec);
    }
    return list->bad ? rad_fail_memory(err) : 0;
}

int
ambfile_parse(struct ambfile *a, const void *bytes, size_t len,
              struct wire_out *list, struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct header h = { 0 };
    struct wire_in in;

    if (copy_header(&h, bytes, len, &why) == 0 &&
        read_header(a, &h, &why) == 0 && fits(a, &h, &why) == 0) {
        wire_in_init(&in, (const char *)bytes + h.len, len - h.len);
        parse_records(a, &in, list, &why);
    }
    free(h.text);
    if (err && err->code == 0)
        *err = why;
    return why.code;
}

int
ambfile_read(struct ambfile *a, const char *path, struct wire_out *list,
             struct rad_error *err)
{
    unsigned char *bytes;
    size_t len;
    int rc;

    if (access(path, F_OK) != 0 && errno == ENOENT)
        return 0;
    bytes = rad_file_read(path, list->max, &len, err);
    if (!bytes)
        return err ? err->code : RAD_ENOINPUT;
    rc = len > 0 ? ambfile_parse(a, bytes, len, list, err) : 0;
    free(bytes);
    if (rc < 0)
        rad_error_where(err, "%s", path);
    return rc;
}

int
ambfile_load(struct ambfile *a, const char *path, struct rad_ambient *amb,
             struct rad_error *err)
{
    struct wire_out list;
    int rc;

    wire_out_init(&list, LARGEST_FILE);
    rc = ambfile_read(a, path, &list, err);
    if (rc == 0 && (rc = ambshare_load(amb, list.buf, list.len, err)) < 0)
        rad_error_where(err, "%s", path);
    wire_out_release(&list);
    return rc;
}

/* --- writing --- */

static void
put_header(const struct ambfile *a, FILE *f)
{
    const struct rad_params *p = &a->params;
    char options[RAD_PARAMS_TEXT];

    fprintf(f, "#?RADIANCE\nSOFTWARE=radd %s\n", PACKAGE_VERSION);
    if (a->format == AMBFILE_OURS) {
        options_text(a, options);
        fprintf(f, "SCENE=%s\nOPTIONS=%s\nFORMAT=" OUR_FORMAT "\n\n", a->scene,
                options);
        return;
    }
    fprintf(f, "radd -av %g %g %g -aw %d -aa %g", (double)p->ambval.r,
            (double)p->ambval.g, (double)p->ambval.b, p->ambvwt, p->ambacc);
    fprintf(f, " -ab %d -ad %d -as %d -ar %d -dr %d", p->ambounce, p->ambdiv,
            p->ambssamp, p->ambres, p->directrelay);
    fprintf(f, " -ds %g -dt %g -dc %g -ss %g -st %g", p->srcsizerat,
            p->shadthresh, p->shadcert, p->specjitter, p->specthresh);
    fprintf(f, " -lr %d -lw %g\nNCOMP=3\nFORMAT=" RADIANCE "\n\n%c%c",
            p->maxdepth, p->minweight, RADIANCE_MAGIC >> 8,
            RADIANCE_MAGIC & 0xff);
}

int
ambfile_format(const struct ambfile *a, const void *list, size_t len, FILE *f,
               struct rad_error *err)
{
    struct wire_out out;
    struct rad_ambrec rec;
    struct wire_in in;
    bool bad;

    put_header(a, f);
    wire_out_init(&out, AMBSHARE_BYTES);
    wire_in_init(&in, list, len);
    while (wire_left(&in) >= AMBSHARE_BYTES && !out.bad) {
        out.len = 0;
        if (!ambshare_unpack(&in, &rec))
            continue;
        if (a->format == AMBFILE_OURS)
            ambshare_pack(&out, &rec);
        else
            put_record(&out, &rec);
        fwrite(out.buf, 1, out.len, f);
    }
    bad = out.bad;
    wire_out_release(&out);
    if (bad)
        return rad_fail_memory(err);
    return ferror(f)
               ? rad_fail(err, RAD_EIO, "cannot write: %s", strerror(errno))
               : 0;
}

int
ambfile_write(const struct ambfile *a, const char *path,
              const struct wire_out *list, bool durable, struct rad_error *err)
{
    struct rad_output out;
    int rc = rad_output_open(&out, path, durable, err);

    if (rc < 0)
        return rc;
    rc = ambfile_format(a, list->buf, list->len, out.file, err);
    if (rc == 0)
        return rad_output_commit(&out, err);
    rad_error_where(err, "%s", path);
    rad_output_abort(&out);
    return rc;
}

int
ambfile_save(const struct ambfile *a, const char *path,
             const struct rad_ambient *amb, struct rad_error *err)
{
    struct rad_ambrec rec[64];
    struct wire_out list;
    uint64_t cursor = 0;
    size_t n;
    int rc;

    wire_out_init(&list, LARGEST_FILE);
    while ((n = rad_ambient_list(amb, &cursor, rec, 64)) > 0)
        for (size_t i = 0; i < n; i++)
            ambshare_pack(&list, &rec[i]);
    rc = list.bad ? rad_fail_memory(err)
                  : ambfile_write(a, path, &list, true, err);
    wire_out_release(&list);
    return rc;
}
