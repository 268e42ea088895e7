# what any daemon stands on: settings, log, loop, disk
libdaemon_a_SOURCES += \
	daemon/ground/conf.c \
	daemon/ground/conf.h \
	daemon/ground/daemon.c \
	daemon/ground/daemon.h \
	daemon/ground/disk.c \
	daemon/ground/disk.h \
	daemon/ground/filter.c \
	daemon/ground/filter.h \
	daemon/ground/lossy.c \
	daemon/ground/lossy.h \
	daemon/ground/mark.c \
	daemon/ground/mark.h \
	daemon/ground/memory.c \
	daemon/ground/memory.h \
	daemon/ground/sanitized.h \
	daemon/ground/service.c \
	daemon/ground/service.h \
	daemon/ground/syncs.c \
	daemon/ground/syncs.h \
	daemon/ground/task.c \
	daemon/ground/task.h \
	daemon/ground/threads.c \
	daemon/ground/threads.h \
	daemon/ground/turns.c \
	daemon/ground/turns.h
