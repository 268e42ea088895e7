/* check_origin.c - where a picture is from, in its header */
#include "config.h"

#include "show/origin.h"

#include "tests/unit.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char text[MSG_MAX_ORIGIN + 1];

static void
put(const char *path, const char *bytes, size_t n)
{
    FILE *f = fopen(path, "wb");

    ck_assert_ptr_nonnull(f);
    ck_assert_uint_eq(fwrite(bytes, 1, n, f), n);
    fclose(f);
}

TEST(scene_files_are_named_without_folders)
{
    const char *scenes[] = { "/home/ana/room.rad", "lamps.rad", "-" };

    origin_text(text, scenes, 3, NULL);
    ck_assert_str_eq(text, "SCENE= room.rad lamps.rad -\n");
}

TEST(an_octree_brings_its_own_lines)
{
    static const char octree[] =
        "#?RADIANCE\noconv -f room.rad\n\tindented\nFORMAT=Radiance_octree\n"
        "VIEW= -vtv\nrpict -vf a.vf\n/usr/bin/rvu -vp 1 2 3\nSOFTWARE= RADIANCE 6\n\n\0binary";
    const char *scenes[] = { "check_origin.oct" };

    put(scenes[0], octree, sizeof octree);
    origin_text(text, scenes, 1, NULL);
    unlink(scenes[0]);
    ck_assert_str_eq(text, "oconv -f room.rad\n?indented\nSOFTWARE= RADIANCE 6\n"
                           "SCENE= check_origin.oct\n");
}

TEST(an_octree_that_is_none_is_only_named)
{
    const char *scenes[] = { "check_origin_none.oct" };

    put(scenes[0], "oconv\n", 6);
    origin_text(text, scenes, 1, NULL);
    unlink(scenes[0]);
    ck_assert_str_eq(text, "SCENE= check_origin_none.oct\n");
    origin_text(text, scenes, 1, NULL); /* which is gone */
    ck_assert_str_eq(text, "SCENE= check_origin_none.oct\n");
    ck_assert_int_eq(mkfifo(scenes[0], 0600), 0);
    origin_text(text, scenes, 1, NULL); /* which would wait for a writer */
    unlink(scenes[0]);
    ck_assert_str_eq(text, "SCENE= check_origin_none.oct\n");
}

TEST(what_a_terminal_obeys_is_no_part_of_it)
{
    const char *scenes[] = { "a\033[2J.rad", "b\nVIEW= -vtl.rad" };

    origin_text(text, scenes, 2, NULL);
    ck_assert_str_eq(text, "SCENE= a?[2J.rad b?VIEW= -vtl.rad\n");
}

TEST(many_names_are_cut_to_fit)
{
    const char *scenes[1000];
    size_t n;

    for (int i = 0; i < 1000; i++)
        scenes[i] = "a-long-name-of-a-scene.rad";
    origin_text(text, scenes, 1000, NULL);
    n = strlen(text);
    ck_assert_uint_lt(n, 1536 + 1);
    ck_assert_str_eq(text + n - 5, " ...\n");
}

TEST(a_stamp_tells_day_host_and_job)
{
    static const uint8_t job[MSG_JOB] = { 0xab };
    struct origin_stamp stamp = { 86400, "ws07", job };
    const char *scenes[] = { "room.rad" };

    origin_text(text, scenes, 1, &stamp);
    ck_assert_ptr_nonnull(strstr(text, "\nCAPDATE= 1970:01:0"));
    ck_assert_ptr_nonnull(strstr(text, "\nGMT= 1970:01:02 00:00:00\n"));
    ck_assert_ptr_nonnull(strstr(text, "\nHOST= ws07\n"));
    ck_assert_ptr_nonnull(
        strstr(text, "\nJOB= ab000000000000000000000000000000\n"));
}
