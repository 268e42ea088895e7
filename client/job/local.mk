# what a job is asked for: options, views, qualities
libclient_a_SOURCES += \
	client/job/figure.c \
	client/job/figure.h \
	client/job/frames.c \
	client/job/frames.h \
	client/job/jobspec.c \
	client/job/jobspec.h \
	client/job/quality.c \
	client/job/quality.h \
	client/job/submit_options.c \
	client/job/submit_options.h
