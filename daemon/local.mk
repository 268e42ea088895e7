# libdaemon, the machines behind the daemons
noinst_LIBRARIES += libdaemon.a
libdaemon_a_CPPFLAGS = $(AM_CPPFLAGS)
libdaemon_a_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(JANSSON_CFLAGS) $(INIH_CFLAGS)
libdaemon_a_SOURCES = \
	daemon/action.c \
	daemon/action.h \
	daemon/coord.h \
	daemon/partition.c \
	daemon/partition.h \
	daemon/worker.h

# what a program that uses libdaemon links with, before $(LIBRAD)
LIBDAEMON = libdaemon.a $(LIBPROTO) $(UV_LIBS) $(JANSSON_LIBS) $(INIH_LIBS)
