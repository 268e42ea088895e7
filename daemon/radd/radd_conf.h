/* radd_conf.h - settings of the worker daemon
 *
 * Thread: the loop's. */
#ifndef DAEMON_RADD_CONF_H
#define DAEMON_RADD_CONF_H

#include "ground/daemon.h"

struct radd_settings {
    struct daemon_settings common;
    char coordinator[CONF_TEXT];
    char name[CONF_TEXT];
    char listen[CONF_TEXT];
    char cache[CONF_TEXT];
    char key[CONF_TEXT];
    char sandbox[CONF_TEXT];
    int threads;
    int memory_mib;
    int nice;
    int pixel_s;
    int load_s;
    int cache_mib;
    char hours[CONF_TEXT];
    bool idle_only;
    bool launched;
};

/* The keys of radd.conf, which are options, too (radd.conf(5)). */
extern const struct conf_table radd_table;

#endif
