/* check_compile.c - tests of client/compile, command and paths
 *
 * Each test works in a folder of its own, which is removed at its end. */
#include "config.h"

#include "compile/compile.h"
#include "scene/octfile.h"
#include "tests/scratch.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FONT "65 4\n\t40 0 220 60 220 255 40 255\n"

static struct compiled c;

static void
set_up(void)
{
    scratch_make();
    unsetenv("RAYPATH");
}

static void
tear_down(void)
{
    compile_release(&c);
    scratch_remove();
}

FIXTURE(set_up, tear_down)

#define FROM(files, n) (&(struct compile_from){ (files), (n), false })

/* dir/name, good until eight more were asked for */
static const char *
in_dir(const char *name)
{
    static char path[8][PATH_MAX + 256];
    static int at;

    at = (at + 1) % 8;
    snprintf(path[at], sizeof path[at], "%s/%s", dir, name);
    return path[at];
}

static void
put_file(const char *name, const char *text)
{
    FILE *f = fopen(in_dir(name), "w");

    ck_assert_ptr_nonnull(f);
    ck_assert_int_ge(fputs(text, f), 0);
    ck_assert_int_eq(fclose(f), 0);
}

/* Read dir/a.rad with this text; the first error's message without the
 * folder, or "". */
static const char *
message_of(const char *text)
{
    static char message[600];
    const char *file = in_dir("a.rad");
    struct rad_error err = { 0 };
    char *p;

    put_file("a.rad", text);
    if (compile_read(&c, FROM(&file, 1), NULL, NULL, &err) == 0) {
        compile_release(&c);
        return "";
    }
    ck_assert_ptr_null(c.scene);
    rad_error_format(&err, message, sizeof message);
    p = strstr(message, "a.rad");
    return p ? p : message;
}

#define SPHERE "void sphere s 0 0 4 0 0 0 1\n"

/* --- commands ------------------------------------------------------------ */

TEST(commands_run_in_their_files_folder)
{
    const char *file;

    mkdir(in_dir("sub"), 0700);
    put_file("sub/part.rad", SPHERE "!cat ./more.rad | \\\n cat\n");
    put_file("sub/more.rad", "void bubble b 0 0 4 1 1 1 2");
    put_file("sub/a.rad", "!cat part.rad\n" SPHERE);
    file = in_dir("sub/a.rad");
    ck_assert_int_eq(compile_read(&c, FROM(&file, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->nobjects, 3);
    ck_assert_int_eq(c.scene->objects[1].type, RAD_BUBBLE);
}

/* As Radiance runs them there, for whoever writes names from a project's folder
 * on; the scene file's own folder comes first. */
TEST(commands_run_in_our_folder_for_files_that_are_only_there)
{
    char *here = getcwd(NULL, 0);
    const char *file = "sub/a.rad";

    mkdir(in_dir("sub"), 0700);
    mkdir(in_dir("parts"), 0700);
    put_file("parts/ball.rad", SPHERE);
    put_file("both.rad", SPHERE SPHERE SPHERE SPHERE);
    put_file("sub/both.rad", SPHERE);
    mkdir(in_dir("sub/own"), 0700);
    put_file("wall.rad", SPHERE SPHERE SPHERE);
    put_file("sub/own/wall.rad", SPHERE);
    put_file("sub/a.rad", "!cat ./parts/ball.rad | cat\n!cat both.rad\n"
                          "!cd own; cat wall.rad\n");
    ck_assert_int_eq(chdir(in_dir(".")), 0);
    ck_assert_int_eq(compile_read(&c, FROM(&file, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->nobjects, 3);
    compile_release(&c);
    ck_assert_int_eq(chdir(here), 0);
    free(here);
}

TEST(much_output_is_read)
{
    static const char text[] =
        "!i=0; while [ $i -lt 4000 ]; do echo 'void sphere a.long.name.for.it"
        " 0 0 4 123.456 234.567 345.678 '$i.5; i=$((i+1)); done\n";
    const char *file = in_dir("a.rad");

    put_file("a.rad", text);
    ck_assert_int_eq(compile_read(&c, FROM(&file, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->nobjects, 4000);
    ck_assert(c.scene->objects[3999].reals[3] == 3999.5);
}

static const struct {
    const char *text, *message;
} failing[] = {
    { SPHERE "\n!exit 3\n", "a.rad:3: '!exit 3' failed with exit status 3" },
    { "!echo '# a comment'; false",
      "a.rad:1: '!echo '# a comment'; false' failed with exit status 1" },
    { "!kill -9 $$", "a.rad:1: '!kill -9 $$' was ended by signal 9" },
    { "!no-such-generator_x 1 2",
      "a.rad:1: program 'no-such-generator_x' is not installed: "
      "'!no-such-generator_x 1 2'" },
    /* the status of a pipeline is its last command's */
    { "!no-such-generator_x 'a|b' | cat",
      "a.rad:1: program 'no-such-generator_x' is not installed: "
      "'!no-such-generator_x 'a|b' | cat'" },
    { "!cat /dev/null | no-such-generator_x",
      "a.rad:1: program 'no-such-generator_x' is not installed: '!cat "
      "/dev/null | no-such-generator_x'" },
    { "!echo void shpere s 0 0 0",
      "a.rad:1 (!echo void shpere s 0 0 0):1: unknown type 'shpere'" },
    { "!cat b.rad", "a.rad:1: '!cat b.rad' failed with exit status 1" },
    { "!cat a.rad", "commands are nested too deeply" },
    { "!while :; do echo x y z 0 0 0; done",
      "a.rad:1 (!while :; do echo x y z 0 0 0; done):1: undefined modifier "
      "'x'" },
    { "!true\n" SPHERE, "" }, /* no output is fine */
    /* these name no further program */
    { "!echo told >&2\n" SPHERE, "" },
    { "!true >|/dev/null 2>&1 # nothing; at-all\n" SPHERE, "" },
    { "!cat 2>&1 | no-such-generator_x # made\n",
      "a.rad:1: program 'no-such-generator_x' is not installed: '!cat 2>&1 | "
      "no-such-generator_x # made'" },
};

LOOP_TEST(failing_commands_are_named, N_ELEM(failing))
{
    const char *message;
    int keep = dup(STDERR_FILENO), null = open("/dev/null", O_WRONLY);

    dup2(null, STDERR_FILENO); /* what the shell says */
    message = message_of(failing[_i].text);
    dup2(keep, STDERR_FILENO);
    close(keep);
    close(null);
    if (strcmp(failing[_i].message, "commands are nested too deeply") == 0)
        ck_assert_ptr_nonnull(strstr(message, failing[_i].message));
    else
        ck_assert_str_eq(message, failing[_i].message);
}

TEST(a_stopped_pipeline_leaves_nothing_running)
{
    char line[32] = "";
    FILE *f;

    message_of("!echo $$ > group; (sleep 1000 | sleep 1000) & echo x y z\n");
    f = fopen(in_dir("group"), "r");
    ck_assert_ptr_nonnull(f);
    ck_assert_ptr_nonnull(fgets(line, sizeof line, f));
    fclose(f);
    /* ended processes that their new parent has not waited for yet are still
     * in the group: wait for them */
    while (kill(-(pid_t)atoi(line), 0) == 0)
        usleep(1000);
    ck_assert_int_eq(errno, ESRCH);
}

TEST(commands_have_no_standard_input)
{
    ck_assert_str_eq(message_of("!cat\n" SPHERE), "");
}

TEST(signals_are_restored)
{
    struct sigaction act = { .sa_handler = SIG_DFL };

    sigaction(SIGINT, &act, NULL);
    message_of("!true\n");
    ck_assert_int_eq(sigaction(SIGINT, NULL, &act), 0);
    ck_assert(act.sa_handler == SIG_DFL);
}

/* --- files --------------------------------------------------------------- */

#define TEXT                                                                   \
    "void brighttext t 2 f.fnt %s 0 11 0 0 0 1 0 0 0 -1 0 1 0\n"               \
    "t plastic m 0 0 5 .5 .5 .5 0 0\nm sphere s 0 0 4 0 0 0 1\n"

static void
put_text_scene(const char *text_file)
{
    char text[512];

    snprintf(text, sizeof text, TEXT, text_file);
    put_file("a.rad", text);
}

/* Compile dir/a.rad into dir/out; its manifest, to be freed. */
static char *
manifest_of(void)
{
    const char *file = in_dir("a.rad");
    struct rad_error err = { 0 };
    size_t len;
    char *text;

    mkdir(in_dir("out"), 0700);
    if (compile_scene(&c, FROM(&file, 1), in_dir("out"), NULL, &err))
        ck_abort_msg("%s: %s", err.where, err.what);
    text = rad_bundle_format(&c.bundle, &len);
    ck_assert_ptr_nonnull(text);
    return text;
}

TEST(bundle_has_all_that_is_needed)
{
    struct rad_bundle_dir where = { &c.bundle, in_dir("out") };
    struct rad_files files = rad_bundle_files(&where);
    struct rad_scene *back;
    char path[PATH_MAX + 512], *manifest;
    unsigned char *bytes;
    size_t len;

    put_file("f.fnt", FONT);
    put_file("page.txt", "a page");
    put_text_scene("page.txt");
    manifest = manifest_of();
    ck_assert_int_eq(c.bundle.n, 3);
    bytes = files.read(files.arg, "page.txt", &len, NULL);
    ck_assert_str_eq((char *)bytes, "a page");
    free(bytes);
    bytes = files.read(files.arg, "f.fnt", &len, NULL);
    ck_assert_str_eq((char *)bytes, FONT);
    free(bytes);
    snprintf(path, sizeof path, "%s/%s", in_dir("out"),
             rad_bundle_find(&c.bundle, RAD_BUNDLE_SCENE, NULL)->hash);
    back = rad_octfile_load(path, NULL);
    ck_assert_ptr_nonnull(back);
    ck_assert_int_eq(back->nobjects, 3);
    rad_scene_free(back);
    free(manifest);
}

TEST(equal_scenes_have_equal_manifests)
{
    char *here, *there, cwd[PATH_MAX];

    put_file("f.fnt", FONT);
    put_file("page.txt", "a page");
    put_text_scene("page.txt");
    here = manifest_of();
    compile_release(&c);
    ck_assert_ptr_nonnull(getcwd(cwd, sizeof cwd));
    ck_assert_int_eq(chdir("/"), 0);
    put_file("a.rad", "");
    put_text_scene("  page.txt # with a comment\n");
    there = manifest_of();
    compile_release(&c);
    ck_assert_int_eq(chdir(cwd), 0);
    ck_assert_str_eq(here, there);
    free(here);
    free(there);
}

TEST(a_missing_file_names_its_object)
{
    char text[512];

    snprintf(text, sizeof text, TEXT, "words here");
    text[strstr(text, "2 f.fnt") - text] = '3';
    ck_assert_str_eq(message_of(text), "a.rad:1: brighttext 't': cannot find "
                                       "file 'f.fnt': RAYPATH is not set");
    setenv("RAYPATH", ".", 1);
    ck_assert_str_eq(message_of(text), "a.rad:1: brighttext 't': cannot find "
                                       "file 'f.fnt'");
    put_file("f.fnt", FONT);
    ck_assert_str_eq(message_of(text), "");
    /* nothing is made of it: its files need not be there */
    ck_assert_str_eq(
        message_of("void brighttext t 2 no.fnt none.txt 0 11 0 0 0 1 0 0 0 -1 "
                   "0 1 0\n" SPHERE),
        "");
}

TEST(raypath_is_searched_in_order)
{
    struct paths p;
    struct rad_error err = { 0 };
    char path[3 * PATH_MAX], *found;

    mkdir(in_dir("one"), 0700);
    mkdir(in_dir("two"), 0700);
    mkdir(in_dir("scene"), 0700);
    mkdir(in_dir("scene/lib"), 0700);
    put_file("one/x", "");
    put_file("two/x", "");
    put_file("two/y", "");
    put_file("scene/y", "");
    put_file("scene/lib/z", "");
    snprintf(path, sizeof path, "lib:%s:%s:.", in_dir("one"), in_dir("two"));
    setenv("RAYPATH", path, 1);
    ck_assert_int_eq(paths_init(&p, NULL), 0);
    ck_assert_int_eq(paths_add_file(&p, in_dir("scene/a.rad"), NULL), 0);
    ck_assert_int_eq(paths_add_file(&p, in_dir("scene/b.rad"), NULL), 0);
    ck_assert_int_eq(p.n, 1);

    static const struct {
        const char *name, *found;
    } looked[] = {
        { "x", "one/x" },
        { "y", "two/y" },       /* before the scene's folder */
        { "./y", "scene/./y" }, /* not along RAYPATH */
        { "z", "scene/lib/z" }, /* a relative entry */
    };

    for (int i = 0; i < N_ELEM(looked); i++) {
        found = paths_find(&p, looked[i].name, NULL);
        ck_assert_ptr_nonnull(found);
        ck_assert_str_eq(found, in_dir(looked[i].found));
        free(found);
    }
    found = paths_find(&p, in_dir("two/x"), NULL);
    ck_assert_ptr_nonnull(found);
    free(found);
    setenv("HOME", in_dir("two"), 1);
    found = paths_find(&p, "~/y", NULL);
    ck_assert_ptr_nonnull(found);
    ck_assert_str_eq(found, in_dir("two/y"));
    free(found);
    ck_assert_ptr_null(paths_find(&p, "lib", &err)); /* a folder */
    ck_assert_int_eq(err.code, RAD_ENOINPUT);
    paths_release(&p);
}

/* --- scene files --------------------------------------------------------- */

TEST(files_make_one_scene)
{
    const char *files[2] = { in_dir("m.rad"), in_dir("s.rad") };

    put_file("m.rad", "void plastic m 0 0 5 .5 .5 .5 0 0\n");
    put_file("s.rad", "m sphere s 0 0 4 0 0 0 1\n");
    ck_assert_int_eq(compile_read(&c, FROM(files, 2), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->objects[1].modifier, 0);
}

/* Freeze dir/a.rad to dir/a.oct. */
static void
freeze(void)
{
    const char *file = in_dir("a.rad");
    struct rad_fd to = { -1, "a.oct" };
    struct rad_sink out = rad_fd_sink(&to);

    ck_assert_int_eq(compile_read(&c, FROM(&file, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(compile_octree(&c, RAD_OCTREE_LEAF, NULL), 0);
    to.fd = open(in_dir("a.oct"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ck_assert_int_ge(to.fd, 0);
    ck_assert_int_eq(rad_octfile_write(c.scene, &c.octree, &out, NULL), 0);
    close(to.fd);
    compile_release(&c);
}

TEST(an_octree_is_a_scene_whatever_its_name)
{
    const char *files[2];
    struct rad_error err = { 0 };

    put_file("a.rad", "void plastic m 0 0 5 .5 .5 .5 0 0\nm "
                      "sphere s 0 0 4 0 0 0 1\n");
    freeze();
    files[0] = in_dir("a.oct");
    ck_assert_int_eq(compile_read(&c, FROM(files, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->nobjects, 2);
    compile_release(&c);
    files[1] = in_dir("a.rad");
    ck_assert_int_eq(compile_read(&c, FROM(files, 2), NULL, NULL, &err),
                     RAD_EUSAGE);
    ck_assert_int_eq(rename(files[0], files[1]), 0);
    ck_assert_int_eq(compile_read(&c, FROM(files + 1, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->nobjects, 2);
}

TEST(a_scene_comes_from_standard_input)
{
    const char *file = "-";

    put_file("a.rad", "!echo " SPHERE SPHERE);
    ck_assert_ptr_nonnull(freopen(in_dir("a.rad"), "r", stdin));
    ck_assert_int_eq(compile_read(&c, FROM(&file, 1), NULL, NULL, NULL), 0);
    ck_assert_int_eq(c.scene->nobjects, 2);
}

static void
count_errors(void *arg, const struct rad_error *err)
{
    ck_assert_int_ne(err->code, 0);
    ++*(int *)arg;
}

TEST(every_error_is_told_once)
{
    const char *files[3] = { in_dir("none.rad"), in_dir("a.rad"),
                             in_dir("b.rad") };
    struct rad_error err = { 0 };
    int n = 0;

    put_file("a.rad", "x sphere s 0 0 4 0 0 0 1\n!exit 1\nvoid sphere");
    put_file("b.rad", "y sphere s 0 0 4 0 0 0 1\n");
    ck_assert_int_eq(compile_read(&c, FROM(files, 3), count_errors, &n, &err),
                     RAD_ENOINPUT);
    ck_assert_int_eq(n, 6); /* with the warning that nothing came of `exit 1` */
    ck_assert_ptr_nonnull(strstr(err.what, "none.rad"));

    n = 0;
    put_file("a.rad",
             "void plastic m 0 0 4 1 1 1 0\nvoid mesh y 1 x.rtm 0 0\n");
    ck_assert_int_eq(
        compile_read(&c, FROM(files + 1, 1), count_errors, &n, NULL),
        RAD_ENOINPUT);
    ck_assert_int_eq(n, 2);
}

/* The scenes of other people, where they are: ours must read them whole. */
LOOP_TEST(known_scenes_compile, 4)
{
    static const struct {
        const char *file;
        int objects;
    } scenes[] = {
        { "office/night.rad", 579 },
        { "cornell/cornell.rad", 14 },
        { "dielectric/dielectric.rad", 42 },
        { "commands/flat.rad", 123 },
    };
    const char *top = getenv("top_srcdir"), *set = getenv("RADD_SCENES");
    char path[PATH_MAX];

    snprintf(path, sizeof path, "%s%s/%s",
             set   ? set
             : top ? top
                   : ".",
             set ? "" : "/../shared/scenes", scenes[_i].file);
    if (access(path, R_OK) != 0) {
        printf("skipped: no %s; RADD_SCENES can name its folder\n", path);
        return;
    }

    const char *file = path;
    struct rad_error err = { 0 };

    if (compile_scene(&c, FROM(&file, 1), dir, NULL, &err))
        ck_abort_msg("%s: %s", err.where, err.what);
    ck_assert_int_eq(c.scene->nobjects, scenes[_i].objects);
}

TEST(the_example_compiles)
{
    const char *top = getenv("top_srcdir"), *file;
    char path[PATH_MAX];
    struct rad_error err = { 0 };

    snprintf(path, sizeof path, "%s/examples/reading-room/room.rad",
             top ? top : ".");
    file = path;
    if (compile_read(&c, FROM(&file, 1), NULL, NULL, &err))
        ck_abort_msg("%s: %s", err.where, err.what);
    ck_assert_int_gt(c.scene->nobjects, 100);
}
