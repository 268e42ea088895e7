# what a job is asked for: options, views, qualities, costs of its lines
libclient_a_SOURCES += \
	client/job/apart.c \
	client/job/apart.h \
	client/job/costs.c \
	client/job/costs.h \
	client/job/frames.c \
	client/job/frames.h \
	client/job/jobspec.c \
	client/job/jobspec.h \
	client/job/quality.c \
	client/job/quality.h \
	client/job/submit_check.c \
	client/job/submit_check.h \
	client/job/submit_options.c \
	client/job/submit_options.h \
	client/job/submit_pairs.c \
	client/job/submit_pairs.h \
	client/job/submit_parse.c \
	client/job/submit_parse.h \
	client/job/submit_table.c \
	client/job/submit_table.h
