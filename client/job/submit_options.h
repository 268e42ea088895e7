/* submit_options.h - what radsubmit is asked for
 *
 * A command line as a struct: submit_parse.h fills it, submit_table.c has the
 * table of options, submit_check.c says which exclude each other. */
#ifndef RADD_CLIENT_SUBMIT_OPTIONS_H
#define RADD_CLIENT_SUBMIT_OPTIONS_H

#include "points/pointspec.h"
#include "base/error.h"
#include "base/params.h"
#include "picture/view.h"
#include "show/show.h"

#include <stdbool.h>
#include <stdio.h>

/* the order of the words in the table of submit_table.c */
enum submit_progress { PROGRESS_AUTO, PROGRESS_ALWAYS, PROGRESS_NEVER };
enum submit_partition {
    PARTITION_AUTO,
    PARTITION_STATIC,
    PARTITION_SCANBAR,
    PARTITION_WINDOW
};
enum submit_order {
    ORDER_NONE = -1, /* was asked for */
    ORDER_FORWARD,
    ORDER_BACKWARD,
    ORDER_RANDOM,
    ORDER_COST
};

enum submit_ambient {
    AMBIENT_NONE = -1, /* was asked for */
    AMBIENT_PASSES,
    AMBIENT_LIVE
};

struct submit_options {
    struct rad_params params;
    int oversample;          /* --oversample: params' -x and -y count samples */
    double clamp;            /* --clamp; 0: off */
    int quality;             /* --quality: the word's number; -1: none */
    bool quality_whole;      /* and nothing of its set was given otherwise */
    double error;            /* --error [%]; 0: not asked for */
    double time_s;           /* --time; 0: not asked for */
    int psample_asked;       /* what -ps said; 0: nothing, or 0 */
    struct rad_view view;    /* as given; rad_view_setup() has accepted it */
    struct pointspec points; /* --points, and rtrace's options */
    const char *for_pixels;  /* the first option that sensor points have no use
                              * for; or NULL */
    /* files; NULL where not given */
    const char *output, *depth;
    const char *ambient;      /* -af */
    const char *views;        /* --views; NULL with -S: stdin */
    bool no_clobber;          /* frames whose pictures are there are left out */
    bool rpict_status;        /* exit as rpict does */
    int first_frame;          /* -S: number of the first view; 0: one picture */
    int format;               /* enum picfile_format */
    int spectral;             /* -co: 1 spectra, 0 colours, -1 by the suffix */
    struct show show;         /* of a .png */
    const char *exposure;     /* as asked for; NULL: not */
    const char *false_colour; /* its scale; NULL: not asked for */
    int tone, bits;           /* the words' numbers; -1: not asked for */
    const char *stats, *preview;
    /* where */
    const char *coordinator;
    const char *key; /* file */
    bool local;
    const char *launch, *address; /* of a cluster whose workers it starts */
    int workers, threads;         /* of an embedded cluster; 0: not said */
    double wait_s;
    /* how */
    int partition, order; /* enum submit_partition, submit_order */
    int ambient_way;      /* enum submit_ambient */
    const char *reuse;    /* a job's id, or "last"; NULL: not said */
    const char *job;      /* --job: an id; NULL: of a new job */
    int windows;          /* 0: by the picture's size */
    const char *estimate; /* "uniform", "20a" or the like; NULL: not said */
    const char *costs;    /* the file that --estimate named; or NULL */
    bool commands;        /* of octrees are run, too */
    bool stamp;           /* the day, the host and the job in the header */
    bool no_balance, no_share, same_bits, fresh_frames, detach, dry_run;
    int priority;
    int memory_mib; /* most that its process on a worker may have; 0: any */
    const char *name;
    int progress;         /* enum submit_progress */
    int report_s;         /* -t: seconds from one line of it to the next; 0: no
                           * matter */
    bool quiet;           /* -w-: no warnings */
    const char *errors;   /* -e: file for what else stderr gets */
    const char *rif_view; /* --view: the one of a .rif file; NULL: all */
    /* what */
    char *const *scenes; /* nscenes names, "-" is stdin */
    int nscenes;
};

/* Defaults. */
void submit_options_init(struct submit_options *o);

/* Jobs that make a picture: one, or one for each plane of -cs. */
int submit_options_planes(const struct submit_options *o);

/* Is a picture written as spectra? */
bool submit_options_spectra(const struct submit_options *o);

/* Is there a goal, --error or --time? */
bool submit_options_goal(const struct submit_options *o);

/* Does the picture's name end in .hsr, which is for spectra? */
bool submit_options_hsr(const struct submit_options *o);

/* Settle o->oversample if --oversample does not: by --quality; without that a
 * .png has smooth edges, for it is for the eye alone. */
void submit_options_samples(struct submit_options *o);

/* rpict's -defaults, with what *o has changed. */
void submit_options_defaults(const struct submit_options *o, FILE *to);

#endif
