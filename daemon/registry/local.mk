# the life of a job and of a connection, limits, statistics
libdaemon_a_SOURCES += \
	daemon/registry/bygone.c \
	daemon/registry/bygone.h \
	daemon/registry/connlife.c \
	daemon/registry/connlife.h \
	daemon/registry/joblife.c \
	daemon/registry/joblife.h \
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
