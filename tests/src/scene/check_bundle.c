/* check_bundle.c - tests of hex, sha and files of src/base, and bundle.c */
#include "config.h"

#include "base/files.h"
#include "base/hex.h"
#include "base/sha.h"
#include "scene/file/bundle.h"
#include "tests/unit.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static int open_fault; /* what open() fails with; 0: it does not */

/* In place of the C library's. */
int
open(const char *path, int flags, ...)
{
    va_list ap;
    int mode;

    va_start(ap, flags);
    mode = va_arg(ap, int);
    va_end(ap);
    errno = open_fault;
    return open_fault ? -1
                      : (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

/* FIPS 180-4's examples */
#define SHA_ABC                                                                \
    "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
#define SHA_EMPTY                                                              \
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"

TEST(digest_matches_the_standard)
{
    char hex[RAD_SHA_HEX + 1];
    struct rad_sha sha;

    ck_assert_int_eq(rad_sha_hex("abc", 3, hex, NULL), 0);
    ck_assert_str_eq(hex, SHA_ABC);
    ck_assert_int_eq(rad_sha_hex(NULL, 0, hex, NULL), 0);
    ck_assert_str_eq(hex, SHA_EMPTY);
    ck_assert_int_eq(rad_sha_init(&sha, NULL), 0);
    rad_sha_update(&sha, "a", 1);
    rad_sha_update(&sha, "bc", 2);
    ck_assert_int_eq(rad_sha_final(&sha, hex, NULL), 0);
    ck_assert_str_eq(hex, SHA_ABC);
}

TEST(only_64_lower_case_digits_are_a_hash)
{
    ck_assert(rad_sha_valid(SHA_ABC));
    ck_assert(!rad_sha_valid(""));
    ck_assert(!rad_sha_valid("../../etc/passwd"));
    ck_assert(!rad_sha_valid(SHA_ABC "0"));
    ck_assert(!rad_sha_valid(&SHA_ABC[1]));
    ck_assert(!rad_sha_valid("BA7816bf8f01cfea414140de5dae2223b00361a396177a9c"
                             "b410ff61f20015ad"));
}

static const struct {
    const char *hex;
    bool read, valid;
} hexes[] = {
    { "00ff7a", true, true },   { "00FF7a", true, false },
    { "00ff7a0", true, false }, { "00ff7", false, false },
    { "00ff7g", false, false }, { "00ff 7", false, false },
    { "", false, false },       { "0xff7a", false, false },
};

LOOP_TEST(only_digits_are_read_and_none_is_missing, N_ELEM(hexes))
{
    static const uint8_t want[] = { 0, 255, 0x7a };
    uint8_t bytes[3];

    ck_assert(rad_hex_valid(hexes[_i].hex, 3) == hexes[_i].valid);
    ck_assert(rad_hex_read(hexes[_i].hex, 3, bytes) == hexes[_i].read);
    if (hexes[_i].read)
        ck_assert_mem_eq(bytes, want, sizeof want);
}

TEST(digest_of_hex_is_hex_again)
{
    static const uint8_t first[] = { 0xba, 0x78, 0x16, 0xbf };
    char hex[RAD_SHA_HEX + 1];
    uint8_t digest[RAD_SHA_BYTES];

    rad_sha_from_hex(SHA_ABC, digest);
    ck_assert_mem_eq(digest, first, sizeof first);
    ck_assert_uint_eq(digest[RAD_SHA_BYTES - 1], 0xad);
    rad_sha_to_hex(digest, hex);
    ck_assert_str_eq(hex, SHA_ABC);
}

/* Digests that differ in their last byte alone. */
static void
digests_ending(uint8_t *list, const char *ends)
{
    memset(list, 0x80, strlen(ends) * RAD_SHA_BYTES);
    for (size_t i = 0; i < strlen(ends); i++)
        list[(i + 1) * RAD_SHA_BYTES - 1] = (uint8_t)ends[i];
}

TEST(list_of_digests_becomes_a_set)
{
    uint8_t list[6 * RAD_SHA_BYTES], wanted[3 * RAD_SHA_BYTES];

    ck_assert_uint_eq(rad_sha_unique(NULL, 0), 0);
    digests_ending(list, "caacba");
    digests_ending(wanted, "abc");
    ck_assert_uint_eq(rad_sha_unique(list, 6), 3);
    ck_assert_mem_eq(list, wanted, sizeof wanted);
    ck_assert_uint_eq(rad_sha_unique(list, 3), 3);
    ck_assert_mem_eq(list, wanted, sizeof wanted);
}

TEST(digest_is_found_in_a_set)
{
    uint8_t list[3 * RAD_SHA_BYTES], one[RAD_SHA_BYTES];

    digests_ending(list, "ace");
    for (const char *c = "abcdef"; *c; c++) {
        digests_ending(one, (const char[]){ *c, '\0' });
        ck_assert(rad_sha_among(list, 3, one) == (strchr("ace", *c) != NULL));
    }
    ck_assert(!rad_sha_among(NULL, 0, one));
}

static void
sample(struct rad_bundle *b)
{
    rad_bundle_init(b);
    ck_assert(
        !rad_bundle_add(b, RAD_BUNDLE_FILE, "two words", SHA_EMPTY, 0, NULL));
    ck_assert(
        !rad_bundle_add(b, RAD_BUNDLE_FILE, "helvet.fnt", SHA_ABC, 3, NULL));
    ck_assert(!rad_bundle_add(b, RAD_BUNDLE_SCENE, NULL, SHA_ABC, 3, NULL));
    ck_assert(
        !rad_bundle_add(b, RAD_BUNDLE_FILE, "helvet.fnt", SHA_ABC, 3, NULL));
}

TEST(manifest_survives_a_round_trip)
{
    static const char expected[] =
        "radd-bundle 1\n" SHA_ABC " 3 scene -\n" SHA_ABC
        " 3 file helvet.fnt\n" SHA_EMPTY " 0 file two words\n";
    struct rad_bundle b, c;
    size_t len;
    char *text, *again;

    sample(&b);
    text = rad_bundle_format(&b, &len);
    ck_assert_str_eq(text, expected);
    ck_assert_uint_eq(len, sizeof expected - 1);
    ck_assert_int_eq(rad_bundle_parse(&c, text, len, NULL), 0);
    again = rad_bundle_format(&c, &len);
    ck_assert_str_eq(again, text);
    ck_assert_uint_eq(rad_bundle_bytes(&c), 3); /* each content once */
    ck_assert_str_eq(rad_bundle_find(&c, RAD_BUNDLE_FILE, "two words")->hash,
                     SHA_EMPTY);
    ck_assert_ptr_null(rad_bundle_find(&c, RAD_BUNDLE_FILE, "-"));
    ck_assert_ptr_nonnull(rad_bundle_find(&c, RAD_BUNDLE_SCENE, NULL));
    free(text);
    free(again);
    rad_bundle_release(&b);
    rad_bundle_release(&c);
}

TEST(one_name_has_one_content)
{
    struct rad_bundle b;

    sample(&b);
    ck_assert_int_eq(
        rad_bundle_add(&b, RAD_BUNDLE_FILE, "helvet.fnt", SHA_EMPTY, 0, NULL),
        RAD_EDATA);
    ck_assert_int_eq(
        rad_bundle_add(&b, RAD_BUNDLE_FILE, "a\nb", SHA_EMPTY, 0, NULL),
        RAD_EDATA);
    ck_assert_int_eq(rad_bundle_add(&b, RAD_BUNDLE_FILE, "x", "../x", 0, NULL),
                     RAD_EDATA);
    ck_assert_int_eq(b.n, 3);
    rad_bundle_release(&b);
}

#define HEAD  "radd-bundle 1\n"
#define SCENE SHA_ABC " 3 scene -\n"

static const char *const bad_manifest[] = {
    "",
    "radd-bundle 2\n" SCENE,
    HEAD,                      /* no scene */
    HEAD SHA_ABC " 3 scene -", /* no newline */
    HEAD SHA_ABC " 3 scene x\n",
    HEAD SHA_ABC " 3 picture x\n",
    HEAD SHA_ABC "  3 scene -\n",
    HEAD SHA_ABC " 03 scene -\n",
    HEAD SHA_ABC " -3 scene -\n",
    HEAD SHA_ABC " 99999999999999999999 scene -\n",
    HEAD SHA_ABC " 3 scene\n",
    HEAD "xyz 3 scene -\n",
    HEAD SCENE SCENE, /* twice */
    HEAD SCENE SHA_ABC " 3 file b\n" SHA_ABC " 3 file a\n",
    HEAD SCENE SHA_ABC " 3 file \n",
    HEAD SCENE SHA_ABC " 3 file a\tb\n",
    HEAD SCENE "\n",
};

LOOP_TEST(bad_manifest_is_refused, N_ELEM(bad_manifest))
{
    struct rad_bundle b;
    struct rad_error err = { 0 };
    const char *s = bad_manifest[_i];

    ck_assert_int_eq(rad_bundle_parse(&b, s, strlen(s), &err), RAD_EDATA);
    ck_assert(err.what[0]);
    ck_assert_ptr_null(b.entries);
}

TEST(files_are_read_by_hash)
{
    char dir[] = "/tmp/check_bundleXXXXXX", path[256];
    struct rad_bundle b;
    struct rad_bundle_dir where = { &b, dir };
    struct rad_files files = rad_bundle_files(&where);
    struct rad_error err = { 0 };
    unsigned char *bytes;
    size_t len;
    FILE *f;

    ck_assert_ptr_nonnull(mkdtemp(dir));
    snprintf(path, sizeof path, "%s/%s", dir, SHA_ABC);
    f = fopen(path, "w");
    fputs("abc", f);
    fclose(f);
    sample(&b);
    bytes = files.read(files.arg, "helvet.fnt", &len, &err);
    ck_assert_ptr_nonnull(bytes);
    ck_assert_uint_eq(len, 3);
    ck_assert_str_eq((char *)bytes, "abc");
    free(bytes);
    ck_assert_ptr_null(files.read(files.arg, "other", &len, &err));
    ck_assert_int_eq(err.code, RAD_ENOINPUT);

    for (int longer = 0; longer < 2; longer++) {
        memset(&err, 0, sizeof err);
        f = fopen(path, "w");
        fputs(longer ? "abcd" : "ab", f);
        fclose(f);
        ck_assert_ptr_null(files.read(files.arg, "helvet.fnt", &len, &err));
        ck_assert_int_eq(err.code, RAD_EDATA);
    }
    rad_bundle_release(&b);
    unlink(path);
    rmdir(dir);
}

TEST(reading_a_folder_is_an_input_error)
{
    struct rad_error err = { 0 };
    size_t len;

    ck_assert_ptr_null(rad_file_read("/", 100, &len, &err));
    ck_assert_int_eq(err.code, RAD_ENOINPUT);
}

/* Else radcoord would call a sound folder damaged, and stay down. */
static const struct {
    int number, code;
} unopened[] = {
    { ENOENT, RAD_ENOINPUT }, { EACCES, RAD_ENOINPUT }, { EIO, RAD_EIO },
    { EMFILE, RAD_ESHORT },   { ENFILE, RAD_ESHORT },   { ENOMEM, RAD_ESHORT },
};

LOOP_TEST(a_file_that_is_not_opened_need_not_be_missing, N_ELEM(unopened))
{
    struct rad_error err = { 0 };

    open_fault = unopened[_i].number;
    ck_assert_int_eq(rad_file_open("/", &err), unopened[_i].code);
    open_fault = 0;
    ck_assert_ptr_nonnull(strstr(err.what, strerror(unopened[_i].number)));
}
