/* replay.c - run a fuzz target on the files of its corpus
 *
 * usage: fuzz_x FILE|FOLDER...
 * Stands in for libFuzzer's main in an ordinary build, so that every input
 * that was ever interesting is a test.  Prints how many inputs ran; an input
 * that crashes ends the program, as it should. */
#include "tests/fuzz/fuzz.h"

#include <dirent.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int
replay_file(const char *path)
{
    struct stat st;
    FILE *f = fopen(path, "rb");
    uint8_t *data;
    size_t n;

    if (!f || fstat(fileno(f), &st) < 0) {
        fprintf(stderr, "%s: %s\n", path, strerror(errno));
        exit(EXIT_FAILURE);
    }
    /* an exact allocation, so that the sanitizers see a read past the end */
    data = malloc(st.st_size ? (size_t)st.st_size : 1);
    if (!data)
        abort();
    n = fread(data, 1, (size_t)st.st_size, f);
    fclose(f);
    LLVMFuzzerTestOneInput(data, n);
    free(data);
    return 1;
}

static int
replay_path(const char *path)
{
    DIR *dir = opendir(path);
    struct dirent *e;
    char name[4096];
    int n = 0;

    if (!dir)
        return replay_file(path);
    while ((e = readdir(dir)) != NULL) {
        if (e->d_name[0] == '.')
            continue;
        snprintf(name, sizeof name, "%s/%s", path, e->d_name);
        n += replay_file(name);
    }
    closedir(dir);
    return n;
}

int
main(int argc, char **argv)
{
    int n = 0;

    for (int i = 1; i < argc; i++)
        n += replay_path(argv[i]);
    printf("%s: %d inputs\n", argv[0], n);
    return n > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
