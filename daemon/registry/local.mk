# the life of a job and of a connection, limits, statistics
libdaemon_a_SOURCES += \
	daemon/registry/coord_conn.c \
	daemon/registry/coord_conn.h \
	daemon/registry/coord_job.c \
	daemon/registry/coord_job.h \
	daemon/registry/coord_keep.c \
	daemon/registry/coord_keep.h \
	daemon/registry/quota.c \
	daemon/registry/quota.h \
	daemon/registry/recover.c \
	daemon/registry/recover.h \
	daemon/registry/reuse.c \
	daemon/registry/reuse.h \
	daemon/registry/stats.c \
	daemon/registry/stats.h \
	daemon/registry/telling.c \
	daemon/registry/telling.h
