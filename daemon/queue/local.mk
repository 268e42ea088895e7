# the life of a job and of a connection, limits, statistics
libdaemon_a_SOURCES += \
	daemon/queue/coord_conn.c \
	daemon/queue/coord_conn.h \
	daemon/queue/coord_job.c \
	daemon/queue/coord_job.h \
	daemon/queue/coord_keep.c \
	daemon/queue/coord_keep.h \
	daemon/queue/quota.c \
	daemon/queue/quota.h \
	daemon/queue/recover.c \
	daemon/queue/recover.h \
	daemon/queue/reuse.c \
	daemon/queue/reuse.h \
	daemon/queue/stats.c \
	daemon/queue/stats.h \
	daemon/queue/telling.c \
	daemon/queue/telling.h
