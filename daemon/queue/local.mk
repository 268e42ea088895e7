# the coordinator's events: connections, the life of a job
libdaemon_a_SOURCES += \
	daemon/queue/coord.c \
	daemon/queue/coord.h \
	daemon/queue/coord_conn.c \
	daemon/queue/coord_job.c \
	daemon/queue/coord_keep.c \
	daemon/queue/recover.c \
	daemon/queue/recover.h
