/* program_files.h - the files that radsubmit writes, and checks of them */
#ifndef RADD_CLIENT_PROGRAM_FILES_H
#define RADD_CLIENT_PROGRAM_FILES_H

#include "program.h"

/* Check that all outputs can be written, and the -af file read, before anything
 * is sent.  RAD_EUSAGE, RAD_ECANTCREAT. */
int program_check_outputs(const struct program *p);
int program_check_ambient(struct program *p);
/* RAD_EUSAGE: an output is an input file.  If that is the file of -e, what was
 * added to it is removed again, and standard error is what it was. */
int program_check_apart(struct program *p);

/* Take results of the job (submit.h). */
int program_on_preview(void *program, const uint8_t *picture, size_t len,
                       struct rad_error *err);
int program_on_frame(void *program, uint32_t frame,
                     const struct rad_memory_out *picture,
                     const struct rad_memory_out *depth, struct rad_error *err);
/* Write the preview of a frame that is whole, whose picture is in colours. */
void program_show_whole(struct program *p, const uint8_t *picture, size_t len);
/* Set p->text, for the header of the points' values. */
void program_fill_text(struct program *p);
/* Write the values of sensor points. */
int program_write_points(struct program *p,
                         const struct pointwriter_light *light,
                         struct rad_error *err);
/* Write --stats: this text, which is freed (NULL: memory is out); for a job
 * without rays, if they are wanted. */
int program_write_stats(struct program *p, char *json);
int program_write_stats_of_none(struct program *p);
int program_on_stats(void *program, const uint8_t *json, size_t len,
                     struct rad_error *err);

/* Tell where results are that could not be written to their place. */
void program_say_where_it_is(const struct program *p);

#endif
