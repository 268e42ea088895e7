/* check_keyfile.c - lines of a key file, good and bad; changes to one */
#include "config.h"

#include "net/key/keyorder.h"

#include "tests/scratch.h"

#include <fcntl.h>
#include <grp.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define HEX16 "00112233445566778899aabbccddeeff"
#define HEX   HEX16 HEX16

static const struct {
    const char *text;
    enum msg_role role;
    const char *name;
    uint32_t number;
    bool retired;
    int64_t expires;
} good[] = {
    { "worker:ws07:k1 " HEX, MSG_ROLE_WORKER, "ws07", 1, false, 0 },
    { "user:ana:k999999\t" HEX "  2027-01-31\n", MSG_ROLE_USER, "ana", 999999,
      false, 1801353600 },
    { "  admin:r.o_o-t:k2 " HEX " 2027-01-31T12:00:01Z\n", MSG_ROLE_ADMIN,
      "r.o_o-t", 2, false, 1801396801 },
    { "# keys\n\n   \n worker:a:k3 retired 2024-02-29\n", MSG_ROLE_WORKER, "a",
      3, true, 1709164800 },
};

static struct keyfile f;

static void
release(void)
{
    keyfile_release(&f);
}

FIXTURE(NULL, release)

LOOP_TEST(a_line_says_whose_key_it_is, N_ELEM(good))
{
    struct rad_error err = { 0 };

    ck_assert_int_eq(
        keyfile_parse(&f, good[_i].text, strlen(good[_i].text), &err), 0);
    ck_assert_uint_eq(f.n, 1);
    ck_assert_int_eq(f.v[0].role, good[_i].role);
    ck_assert_str_eq(f.v[0].name, good[_i].name);
    ck_assert_uint_eq(f.v[0].number, good[_i].number);
    ck_assert(f.v[0].retired == good[_i].retired);
    ck_assert_int_eq(f.v[0].expires, good[_i].expires);
    if (!f.v[0].retired) {
        ck_assert_uint_eq(f.v[0].secret[1], 0x11);
        ck_assert_uint_eq(f.v[0].secret[31], 0xff);
    }
}

#define N63 "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
static const struct {
    const char *text, *where, *what;
} bad[] = {
    { "worker:ws07 " HEX, "line 1", "ROLE:NAME:kN" },
    { "# a\n:ws07:k1 " HEX, "line 2", "ROLE:NAME:kN" },
    { "peer:ws07:k1 " HEX, "line 1", "ROLE:NAME:kN" },
    { "work:ws07:k1 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker::k1 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a/b:k1 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:" N63 "aa:k1 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:k0 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:k01 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:k " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:1 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:k1000000 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:k1:k2 " HEX, "line 1", "ROLE:NAME:kN" },
    { "worker:a:k1", "line 1", "64 hexadecimal" },
    { "worker:a:k1 " HEX "0", "line 1", "64 hexadecimal" },
    { "worker:a:k1 g" HEX16 "0112233445566778899aabbccddeeff", "line 1",
      "64 hexadecimal" },
    { "worker:a:k1 Retired", "line 1", "64 hexadecimal" },
    { "worker:a:k1 " HEX " 2027-02-29", "line 1", "date" },
    { "worker:a:k1 " HEX " 2027-1-31", "line 1", "date" },
    { "worker:a:k1 " HEX " 1970-01-01", "line 1", "date" },
    { "worker:a:k1 " HEX " 2027-01-31T24:00:00Z", "line 1", "date" },
    { "worker:a:k1 " HEX " 2027-01-31 x", "line 1", "behind the key" },
    { "worker:a:k1 " HEX "\nworker:a:k1 retired", "line 2", "there already" },
};

LOOP_TEST(a_bad_line_is_named_and_its_secret_is_not, N_ELEM(bad))
{
    struct rad_error err = { 0 };

    ck_assert_int_eq(
        keyfile_parse(&f, bad[_i].text, strlen(bad[_i].text), &err),
        RAD_ECONFIG);
    ck_assert_str_eq(err.where, bad[_i].where);
    ck_assert_msg(strstr(err.what, bad[_i].what) != NULL, "%s", err.what);
    ck_assert_ptr_null(strstr(err.what, "0011"));
    ck_assert_uint_eq(f.n, 0);
    ck_assert_ptr_null(f.text);
}

TEST(bounds_of_a_file_are_kept)
{
    struct rad_error err = { 0 };
    size_t room = 2 * KEY_MAX_FILE, n = 0;
    char *text = malloc(room);

    ck_assert_ptr_nonnull(text);
    for (int i = 1; i <= KEY_MOST; i++)
        n += (size_t)snprintf(text + n, room - n, "user:u:k%d " HEX "\n", i);
    ck_assert_int_eq(keyfile_parse(&f, text, n, NULL), 0);
    ck_assert_uint_eq(f.n, KEY_MOST);
    ck_assert_int_eq(keyfile_add(&f, "user:v", 0, &err), RAD_ECONFIG);
    ck_assert_str_eq(err.what, "a file holds at most 4096 keys");
    keyfile_release(&f);
    n += (size_t)snprintf(text + n, room - n, "user:v:k1 " HEX "\n");
    ck_assert_int_eq(keyfile_parse(&f, text, n, NULL), RAD_ECONFIG);
    memset(text, '#', room);
    ck_assert_int_eq(keyfile_parse(&f, text, KEY_MAX_FILE, NULL), 0);
    keyfile_release(&f);
    ck_assert_int_eq(keyfile_parse(&f, text, KEY_MAX_FILE + 1, NULL),
                     RAD_ECONFIG);
    memset(text, 'a', 1000);
    ck_assert_int_eq(keyfile_parse(&f, text, 1000, NULL), RAD_ECONFIG);
    ck_assert_int_eq(keyfile_parse(&f, "worker:a:k1\0 " HEX, 76, NULL),
                     RAD_ECONFIG);
    free(text);
}

TEST(the_numbers_of_a_name_come_to_an_end)
{
    static const char text[] = "user:u:k999998 " HEX "\n";
    struct rad_error err = { 0 };

    ck_assert_int_eq(keyfile_parse(&f, text, strlen(text), NULL), 0);
    ck_assert_int_eq(keyfile_add(&f, "user:u", 0, NULL), 0);
    ck_assert_int_eq(keyfile_add(&f, "user:u", 0, &err), RAD_ECONFIG);
    ck_assert_str_eq(err.what, "'user:u' has had k999999, the last");
    ck_assert_int_eq(keyfile_add(&f, "user:v", 0, NULL), 0);
}

TEST(both_keys_of_a_rotation_count_until_one_is_retired)
{
    static const char text[] = "# mine\nuser:bo:k1 " HEX;
    struct key old;

    ck_assert_int_eq(keyfile_parse(&f, text, strlen(text), NULL), 0);
    ck_assert_int_eq(keyfile_add(&f, "worker:w", 0, NULL), 0);
    ck_assert_int_eq(keyfile_add(&f, "worker:w", 0, NULL), 0);
    ck_assert_uint_eq(f.n, 3);
    old = f.v[1];
    ck_assert(memcmp(old.secret, f.v[2].secret, KEY_SECRET) != 0);
    ck_assert_int_eq(key_state(keyfile_find(&f, "worker:w:k1"), 1), KEY_VALID);
    ck_assert_int_eq(key_state(keyfile_find(&f, "worker:w:k2"), 1), KEY_VALID);
    ck_assert_uint_eq(keyfile_best(&f, MSG_ROLE_WORKER, 1)->number, 2);
    ck_assert_int_eq(keyfile_retire(&f, "worker:w:k1", NULL), 1);
    ck_assert_int_eq(keyfile_retire(&f, "worker:w:k1", NULL), 0);
    ck_assert_int_eq(key_state(keyfile_find(&f, "worker:w:k1"), 1),
                     KEY_RETIRED);
    ck_assert_int_eq(key_state(keyfile_find(&f, "worker:w:k2"), 1), KEY_VALID);
    /* its number is not given again, and its secret is forgotten */
    ck_assert_int_eq(keyfile_retire(&f, "worker:w", NULL), 1);
    ck_assert_int_eq(keyfile_add(&f, "worker:w", 0, NULL), 0);
    ck_assert_uint_eq(f.v[3].number, 3);
    for (int i = 0; i < KEY_SECRET; i++)
        ck_assert_uint_eq(f.v[1].secret[i], 0);
    ck_assert_ptr_null(keyfile_best(&f, MSG_ROLE_ADMIN, 1));
    ck_assert_int_eq(strncmp(f.text, text, strlen(text)), 0);
}

TEST(a_key_ends_when_its_date_comes)
{
    int64_t at = 0;
    char text[KEY_DATE];

    ck_assert_int_eq(keyfile_parse(&f, "", 0, NULL), 0);
    ck_assert_int_eq(key_date_parse("2027-01-31", &at, NULL), 0);
    key_date_format(at, text);
    ck_assert_str_eq(text, "2027-01-31");
    key_date_format(at + 1, text);
    ck_assert_str_eq(text, "2027-01-31T00:00:01Z");
    ck_assert_int_eq(key_date_parse("tomorrow", &at, NULL), RAD_EUSAGE);
    ck_assert_int_eq(keyfile_add(&f, "user:ana", at, NULL), 0);
    ck_assert_int_eq(key_state(&f.v[0], at - 1), KEY_VALID);
    ck_assert_int_eq(key_state(&f.v[0], at), KEY_EXPIRED);
    ck_assert_ptr_null(keyfile_best(&f, MSG_ROLE_USER, at));
}

static const char *const no_names[] = {
    "ana", "", "user:", "user:a b", "user:a:k1", "root:a", "user:a\nb"
};

LOOP_TEST(only_names_get_keys, N_ELEM(no_names))
{
    ck_assert_int_eq(keyfile_parse(&f, "", 0, NULL), 0);
    ck_assert_int_eq(keyfile_add(&f, no_names[_i], 0, NULL), RAD_EUSAGE);
    ck_assert_int_eq(keyfile_retire(&f, "user:nobody", NULL), RAD_ENOINPUT);
    ck_assert_uint_eq(f.n, 0);
}

static char path[128];

static void
set_up(void)
{
    scratch_make();
    snprintf(path, sizeof path, "%s/keys", dir);
}

static void
tear_down(void)
{
    release();
    unlink(path);
    ck_assert_int_eq(rmdir(dir), 0); /* no temporary file was left */
}

FIXTURE(set_up, tear_down)

static int
order(enum msg_key_order what, const char *name, char **json)
{
    struct key_order o = { what, name, 0, false };

    return key_order_run(path, &o, 1, json, NULL);
}

TEST(orders_change_the_file_and_say_what_they_did)
{
    struct stat st;
    char *json;

    umask(0);
    ck_assert_int_eq(order(MSG_KEY_LIST, "", &json), RAD_ENOINPUT);
    ck_assert_int_eq(order(MSG_KEY_RETIRE, "user:a", &json), RAD_ENOINPUT);
    ck_assert_int_eq(access(path, F_OK), -1);
    ck_assert_int_eq(order(MSG_KEY_ADD, "user:a", &json), 0);
    ck_assert_int_eq(stat(path, &st), 0);
    ck_assert_uint_eq(st.st_mode & 07777, 0600);
    ck_assert_int_eq(keyfile_load(&f, path, NULL), 0);
    ck_assert_uint_eq(f.n, 1);
    ck_assert_ptr_nonnull(strstr(json, "\"key\": \"user:a:k1\""));
    f.text[f.len - 1] = '\0'; /* its only line */
    ck_assert_ptr_nonnull(strstr(json, f.text));
    free(json);
    ck_assert_int_eq(order(MSG_KEY_LIST, "", &json), 0);
    ck_assert_ptr_nonnull(strstr(json, "\"valid\""));
    ck_assert_ptr_null(strstr(json, f.text + strlen("user:a:k1 ")));
    free(json);
    keyfile_release(&f);
    ck_assert_int_eq(order(MSG_KEY_RETIRE, "user:a", &json), 0);
    ck_assert_str_eq(json, "{ \"retired\": 1 }");
    free(json);
}

/* The largest list that a key file makes, which is not told in pages. */
TEST(a_list_of_all_keys_fits_an_answer)
{
    char name[MSG_MAX_NAME + 1], *json = NULL;
    FILE *out;

    out = fopen(path, "w");
    ck_assert_ptr_nonnull(out);
    fchmod(fileno(out), 0600);
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    for (int i = 1; i <= KEY_MOST; i++)
        fprintf(out, "worker:%s:k%d %064d 2027-01-31T12:00:00Z\n", name, i, i);
    fclose(out);
    ck_assert_int_eq(order(MSG_KEY_LIST, "", &json), 0);
    ck_assert_uint_gt(strlen(json), KEY_MOST * 100);
    ck_assert_uint_le(strlen(json), MSG_MAX - 4);
    free(json);
}

/* The file that a link leads to is the one that changes. */
TEST(links_are_followed_and_stay)
{
    char link_path[160];
    struct stat st;
    char *json;

    snprintf(link_path, sizeof link_path, "%s/link", dir);
    ck_assert_int_eq(symlink("keys", link_path), 0); /* to nothing yet */
    for (int i = 0; i < 2; i++) {
        struct key_order add = { MSG_KEY_ADD, "user:a", 0, false };

        ck_assert_int_eq(key_order_run(link_path, &add, 1, &json, NULL), 0);
        free(json);
    }
    ck_assert_int_eq(lstat(link_path, &st), 0);
    ck_assert(S_ISLNK(st.st_mode));
    ck_assert_int_eq(keyfile_load(&f, path, NULL), 0);
    ck_assert_uint_eq(f.n, 2);
    ck_assert_int_eq(unlink(link_path), 0);
}

/* Retired in one name, a key would be good in the other. */
TEST(file_of_two_names_is_not_changed)
{
    char second[160], *json;

    snprintf(second, sizeof second, "%s/second", dir);
    ck_assert_int_eq(order(MSG_KEY_ADD, "user:a", &json), 0);
    free(json);
    ck_assert_int_eq(link(path, second), 0);
    ck_assert_int_eq(order(MSG_KEY_RETIRE, "user:a", &json), RAD_EPERM);
    ck_assert_int_eq(keyfile_load(&f, second, NULL), 0);
    ck_assert(!f.v[0].retired);
    ck_assert_int_eq(unlink(second), 0);
}

/* A user who is not in the group of its file. */
TEST(group_that_cannot_be_kept_is_let_go)
{
    enum { NOBODY = 65534, STRANGE_GROUP = 64123 };
    char *json;
    int status;
    pid_t pid;

    if (geteuid() != 0)
        return;
    ck_assert_int_eq(order(MSG_KEY_ADD, "user:a", &json), 0);
    free(json);
    ck_assert_int_eq(chown(dir, NOBODY, NOBODY), 0);
    ck_assert_int_eq(chown(path, NOBODY, STRANGE_GROUP), 0);
    pid = fork();
    if (pid == 0) {
        if (setgroups(0, NULL) < 0 || setgid(NOBODY) < 0 || setuid(NOBODY) < 0)
            _exit(2);
        _exit(order(MSG_KEY_ADD, "user:b", &json) == 0 ? 0 : 1);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert(WIFEXITED(status));
    ck_assert_int_eq(WEXITSTATUS(status), 0);
}

TEST(a_key_that_has_expired_is_not_made)
{
    const int64_t end = 1800000000;
    struct key_order o = { MSG_KEY_ADD, "user:a", end, false };
    char *json;

    ck_assert_int_eq(key_order_run(path, &o, end, &json, NULL), RAD_EUSAGE);
    ck_assert_ptr_null(json);
    ck_assert_int_eq(access(path, F_OK), -1);
    ck_assert_int_eq(key_order_run(path, &o, end - 1, &json, NULL), 0);
    free(json);
    o = (struct key_order){ MSG_KEY_RETIRE, "user:a", 0, false };
    ck_assert_int_eq(key_order_run(path, &o, end, &json, NULL), 0);
    free(json);
}

static const mode_t open_modes[] = { 0640, 0604, 0620, 0602, 0601, 0660 };

LOOP_TEST(a_file_that_others_may_open_is_refused, N_ELEM(open_modes))
{
    char *json;

    ck_assert_int_eq(order(MSG_KEY_ADD, "user:a", &json), 0);
    free(json);
    ck_assert_int_eq(chmod(path, open_modes[_i]), 0);
    ck_assert_int_eq(keyfile_load(&f, path, NULL), RAD_EPERM);
    ck_assert_int_eq(order(MSG_KEY_ADD, "user:a", &json), RAD_EPERM);
    ck_assert_int_eq(chmod(path, 0400), 0);
    ck_assert_int_eq(keyfile_load(&f, path, NULL), 0);
    ck_assert_uint_eq(f.n, 1);
}

/* systemd's way: an access list shows as root's group that may read. */
TEST(credentials_of_systemd_are_taken)
{
    char *json;

    if (geteuid() != 0)
        return;
    ck_assert_int_eq(order(MSG_KEY_ADD, "user:a", &json), 0);
    free(json);
    ck_assert_int_eq(chmod(path, 0440), 0);
    ck_assert_int_eq(keyfile_load(&f, path, NULL), RAD_EPERM);
    setenv("CREDENTIALS_DIRECTORY", dir, 1);
    ck_assert_int_eq(keyfile_load(&f, path, NULL), 0);
    keyfile_release(&f);
    ck_assert_int_eq(chmod(path, 0444), 0);
    ck_assert_int_eq(keyfile_load(&f, path, NULL), RAD_EPERM);
    unsetenv("CREDENTIALS_DIRECTORY");
}

TEST(a_file_that_cannot_be_is_an_error)
{
    struct rad_error err = { 0 };
    int fd;

    ck_assert_int_eq(keyfile_load(&f, dir, NULL), RAD_ENOINPUT);
    fd = open(path, O_WRONLY | O_CREAT, 0600);
    ck_assert_int_eq(write(fd, "\n\nx\n", 4), 4);
    close(fd);
    ck_assert_int_eq(keyfile_load(&f, path, &err), RAD_ECONFIG);
    ck_assert_msg(strcmp(err.where + strlen(err.where) - 7, "/keys:3") == 0,
                  "%s", err.where);
}
