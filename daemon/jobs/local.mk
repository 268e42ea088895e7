# what the coordinator knows of one job
libdaemon_a_SOURCES += \
	daemon/jobs/attempt.c \
	daemon/jobs/attempt.h \
	daemon/jobs/frame.c \
	daemon/jobs/frame.h \
	daemon/jobs/goal.c \
	daemon/jobs/goal.h \
	daemon/jobs/job.c \
	daemon/jobs/job.h \
	daemon/jobs/kept.c \
	daemon/jobs/kept.h \
	daemon/jobs/life.c \
	daemon/jobs/life.h \
	daemon/jobs/part.c \
	daemon/jobs/part.h \
	daemon/jobs/progress.c \
	daemon/jobs/progress.h \
	daemon/jobs/shared.c \
	daemon/jobs/shared.h \
	daemon/jobs/unit.c \
	daemon/jobs/unit.h
