/* bsdfxml.c - the elements of an XML file as a tree
 *
 * The text of an element is collected in a buffer, and put into the arena when
 * the element ends. */
#include "config.h"

#include "scene/bsdf/bsdfimpl.h"

#include <expat.h>
#include <stdlib.h>
#include <string.h>

/* Expat 2.9 warns of the older name. */
#if XML_MAJOR_VERSION == 2 && XML_MINOR_VERSION < 9
#define XML_GetCurrentLineNumber64 XML_GetCurrentLineNumber
#endif

#define MAX_DEPTH 64
#define MAX_BYTES (1 << 30)

struct reader {
    XML_Parser xml;
    struct rad_arena *arena;
    struct rad_error *err;
    struct xml_node *root;
    struct open {
        struct xml_node *node, **tail; /* tail: link for its next kid */
    } open[MAX_DEPTH];
    int depth, nodes;
    char *text; /* of the innermost element, so far */
    size_t used, size;
    bool failed;
};

static void
fail(struct reader *in, int code, const char *what)
{
    if (!in->failed)
        rad_fail(in->err, code, "line %lu: %s",
                 (unsigned long)XML_GetCurrentLineNumber64(in->xml), what);
    in->failed = true;
    XML_StopParser(in->xml, XML_FALSE);
}

static void
start_element(void *arg, const XML_Char *name, const XML_Char **attributes)
{
    struct reader *in = arg;
    struct xml_node *n;

    (void)attributes;
    if (in->failed)
        return;
    if (in->depth == MAX_DEPTH || in->nodes++ == RAD_MAX_BSDF_NODES) {
        fail(in, RAD_EDATA, "too many elements");
        return;
    }
    n = rad_arena_calloc(in->arena, 1, sizeof *n);
    if (n)
        n->name = rad_arena_strndup(in->arena, name, strlen(name));
    if (!n || !n->name) {
        fail(in, RAD_ENOMEM, "out of memory");
        return;
    }
    n->text = "";
    if (in->depth == 0) {
        in->root = n;
    } else {
        struct open *up = &in->open[in->depth - 1];

        *up->tail = n;
        up->tail = &n->next;
    }
    in->open[in->depth++] = (struct open){ n, &n->kid };
    in->used = 0;
}

static void
add_text(void *arg, const XML_Char *s, int len)
{
    struct reader *in = arg;
    size_t n = (size_t)len;

    if (in->failed)
        return;
    if (n > in->size - in->used) {
        size_t size = 2 * (in->used + n);
        char *more = size < MAX_BYTES ? realloc(in->text, size) : NULL;

        if (!more) {
            fail(in, RAD_ENOMEM, "out of memory");
            return;
        }
        in->text = more;
        in->size = size;
    }
    memcpy(in->text + in->used, s, n);
    in->used += n;
}

static bool
is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

static void
end_element(void *arg, const XML_Char *name)
{
    struct reader *in = arg;
    const char *s = in->used ? in->text : "", *end = s + in->used;
    struct xml_node *n;

    (void)name;
    if (in->failed)
        return;
    n = in->open[--in->depth].node;
    while (s < end && is_blank(*s))
        s++;
    while (end > s && is_blank(end[-1]))
        end--;
    if (!n->kid)
        n->text = rad_arena_strndup(in->arena, s, (size_t)(end - s));
    if (!n->text)
        fail(in, RAD_ENOMEM, "out of memory");
    in->used = 0;
}

/* BSDF files define no entities, which may expand to more than memory holds. */
static void
refuse_entity(void *arg, const XML_Char *name, int parameter,
              const XML_Char *value, int len, const XML_Char *base,
              const XML_Char *system, const XML_Char *public,
              const XML_Char *notation)
{
    (void)name, (void)parameter, (void)value, (void)len, (void)base,
        (void)system, (void)public, (void)notation;
    fail(arg, RAD_EDATA, "defines an entity");
}

struct xml_node *
rad_xml_parse(struct rad_arena *arena, const char *xml, size_t len,
              struct rad_error *err)
{
    struct reader in = { .arena = arena, .err = err };

    if (len > MAX_BYTES / 2) {
        rad_fail(err, RAD_EDATA, "XML file too large");
        return NULL;
    }
    in.xml = XML_ParserCreate(NULL);
    if (!in.xml) {
        rad_fail_memory(err);
        return NULL;
    }
    XML_SetUserData(in.xml, &in);
    XML_SetElementHandler(in.xml, start_element, end_element);
    XML_SetCharacterDataHandler(in.xml, add_text);
    XML_SetEntityDeclHandler(in.xml, refuse_entity);
    if (XML_Parse(in.xml, xml, (int)len, 1) == XML_STATUS_ERROR) {
        enum XML_Error code = XML_GetErrorCode(in.xml);

        fail(&in, code == XML_ERROR_NO_MEMORY ? RAD_ENOMEM : RAD_EDATA,
             XML_ErrorString(code));
    }
    XML_ParserFree(in.xml);
    free(in.text);
    return in.failed ? NULL : in.root;
}

static const struct xml_node *
find(const struct xml_node *n, const char *name)
{
    while (n && strcmp(n->name, name) != 0)
        n = n->next;
    return n;
}

const struct xml_node *
rad_xml_kid(const struct xml_node *n, const char *name)
{
    return n ? find(n->kid, name) : NULL;
}

const struct xml_node *
rad_xml_next(const struct xml_node *n)
{
    return find(n->next, n->name);
}

const char *
rad_xml_text(const struct xml_node *n, const char *name)
{
    const struct xml_node *kid = rad_xml_kid(n, name);

    return kid ? kid->text : "";
}
