# libdaemon, the machines behind the daemons
noinst_LIBRARIES += libdaemon.a
libdaemon_a_CPPFLAGS = $(AM_CPPFLAGS)
libdaemon_a_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(JANSSON_CFLAGS) $(INIH_CFLAGS)
libdaemon_a_SOURCES = \
	daemon/action.c \
	daemon/action.h \
	daemon/coord.c \
	daemon/coord.h \
	daemon/job.c \
	daemon/job.h \
	daemon/lossy.c \
	daemon/lossy.h \
	daemon/partition.c \
	daemon/partition.h \
	daemon/peer.c \
	daemon/peer.h \
	daemon/report.c \
	daemon/report.h \
	daemon/sched.c \
	daemon/sched.h \
	daemon/stats.c \
	daemon/stats.h \
	daemon/worker.c \
	daemon/worker.h

# what a program that uses libdaemon links with, before $(LIBRAD)
LIBDAEMON = libdaemon.a $(LIBPROTO) $(UV_LIBS) $(JANSSON_LIBS) $(INIH_LIBS)
