/* submit_options.h - radsubmit's command line as a struct
 *
 * submit_parse.h fills it, submit_table.c has the table of options,
 * submit_pairs.c that of options which exclude or need each other, and
 * submit_check.c checks values. */
#ifndef RADD_CLIENT_SUBMIT_OPTIONS_H
#define RADD_CLIENT_SUBMIT_OPTIONS_H

#include "points/pointspec.h"
#include "base/error.h"
#include "base/params.h"
#include "picture/view.h"
#include "proto/msg_basics.h"
#include "show/show.h"

#include <stdbool.h>
#include <stdio.h>

/* These, enum msg_partition and enum msg_order are in the order of the words in
 * submit_table.c. */
enum submit_progress { PROGRESS_AUTO, PROGRESS_ALWAYS, PROGRESS_NEVER };
#define PARTITION_NONE (-1) /* not asked for */
#define ORDER_NONE (-1)     /* not asked for */
enum submit_ambient {
    AMBIENT_NONE = -1, /* not asked for */
    AMBIENT_PASSES,
    AMBIENT_LIVE
};

struct submit_options {
    struct rad_params params;
    int oversample;          /* --oversample; -x and -y count samples then */
    double clamp;            /* --clamp; 0: off */
    int quality;             /* --quality: number of the word; -1: none */
    bool quality_whole;      /* no option of its set was given by itself */
    bool ambres_given;       /* -ar */
    double error;            /* --error [%]; 0: not asked for */
    double time_s;           /* --time; 0: not asked for */
    int psample_asked;       /* the value of -ps; 0: not given, or 0 */
    bool names_dropped;      /* -ae after -ai, or the other way round */
    struct rad_view view;    /* as given; rad_view_setup() has accepted it */
    struct pointspec points; /* --points, and rtrace's options */
    const char *for_pixels;  /* the first option given that is not for sensor
                              * points; or NULL */
    /* files; NULL: not given */
    const char *output, *depth;
    const char *ambient;      /* -af */
    const char *views;        /* --views; NULL with -S: stdin */
    bool no_clobber;          /* leave out frames whose pictures exist */
    bool rpict_status;        /* use rpict's exit statuses */
    int first_frame;          /* -S: number of the first view; 0: one picture */
    int format;               /* enum picfile_format */
    int spectral;             /* -co: 1 spectra, 0 colours, -1 by the suffix */
    struct show show;         /* of a .png */
    const char *exposure;     /* as given; NULL: not asked for */
    const char *false_colour; /* the scale; NULL: not asked for */
    int tone, bits;           /* numbers of the words; -1: not asked for */
    const char *stats, *preview;
    /* the cluster */
    const char *coordinator;
    const char *key; /* a file */
    bool local;
    const char *launch, *address; /* --launch: command, address to dial */
    int workers, threads;         /* of --local or --launch; 0: not given */
    double wait_s;
    /* the job */
    int partition;        /* enum msg_partition */
    int order;            /* enum msg_order, or ORDER_NONE */
    int ambient_way;      /* enum submit_ambient */
    const char *reuse;    /* a job's id, or "last"; NULL: not given */
    const char *job;      /* --job: the id of a former job; NULL: a new job */
    int windows;          /* 0: by the picture's size */
    const char *estimate; /* "uniform", "20a" or the like; NULL: not given */
    const char *costs;    /* the FILE of --estimate=FILE; or NULL */
    bool commands;        /* run commands of octrees, too */
    bool stamp;           /* put day, host and job into the header */
    bool no_balance, no_share, same_bits, fresh_frames, detach, dry_run;
    int priority;
    int memory_mib; /* most memory of a worker's process; 0: no limit */
    const char *name;
    int progress;         /* enum submit_progress */
    int report_s;         /* -t: seconds between two reports; 0: not given */
    bool quiet;           /* -w-: no warnings */
    const char *errors;   /* -e: file for everything else on standard error */
    const char *rif_view; /* --view: one view of a .rif file; NULL: all */
    /* the scene */
    char *const *scenes; /* nscenes names; "-": standard input */
    int nscenes;
};

/* Set the defaults. */
void submit_options_init(struct submit_options *o);

/* The number of planes of -cs, each of which is a job; 0: the picture shows
 * red, green and blue, or one plane that was asked for. */
int submit_options_planes(const struct submit_options *o);

/* Is the picture written as spectra? */
bool submit_options_spectra(const struct submit_options *o);

/* Do the options use an ambient cache? */
bool submit_options_cache(const struct submit_options *o);

/* Is there a goal: --error or --time? */
bool submit_options_goal(const struct submit_options *o);

/* Does the picture's name end in .hsr, for spectra? */
bool submit_options_hsr(const struct submit_options *o);

/* Set o->oversample if --oversample was not given: by --quality; else a .png
 * gets smooth edges, for it is only looked at. */
void submit_options_samples(struct submit_options *o);

/* Print rpict's -defaults, with the changes in *o. */
void submit_options_defaults(const struct submit_options *o, FILE *to);

#endif
