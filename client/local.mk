# What the clients share, as a library so that tests can link it.
noinst_LIBRARIES += libclient.a
libclient_a_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_SYSCONFDIR='"$(sysconfdir)"' \
	-DRADD_LIBEXECDIR='"$(pkglibexecdir)"'
libclient_a_CFLAGS = $(AM_CFLAGS) $(JANSSON_CFLAGS) \
	$(UV_CFLAGS)
libclient_a_SOURCES = \
	client/rays.c \
	client/rays.h \
	daemon/machine/lists.c \
	daemon/machine/lists.h
include client/common/local.mk
include client/compile/local.mk
include client/show/local.mk
include client/records/local.mk
include client/link/local.mk
include client/points/local.mk
include client/job/local.mk
include client/rif/local.mk
include client/trial/local.mk
include client/ctl/local.mk

# what a client links with, before LIBRAD
LIBCLIENT = libclient.a libdaemon.a $(LIBNET) $(JANSSON_LIBS)

bin_PROGRAMS += radscene
radscene_SOURCES = client/radscene.c
radscene_LDADD = $(LIBCLIENT) $(LIBRAD)

bin_PROGRAMS += radctl radsubmit
radctl_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_SYSCONFDIR='"$(sysconfdir)"'
radctl_CFLAGS = $(AM_CFLAGS) $(JANSSON_CFLAGS) $(UV_CFLAGS) $(CURSES_CFLAGS)
radctl_LDADD = $(LIBCLIENT) $(CURSES_LIBS) $(LIBDAEMON) $(LIBRAD)
radsubmit_SOURCES = \
	client/program.h \
	client/program_cluster.c \
	client/program_cluster.h \
	client/program_files.c \
	client/program_files.h \
	client/program_job.c \
	client/program_job.h \
	client/program_loop.c \
	client/program_loop.h \
	client/program_planes.c \
	client/program_planes.h \
	client/program_say.c \
	client/program_say.h \
	client/program_scene.c \
	client/program_scene.h \
	client/program_stream.c \
	client/program_stream.h \
	client/radsubmit.c
radsubmit_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_LIBEXECDIR='"$(pkglibexecdir)"'
radsubmit_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
radsubmit_LDADD = $(LIBCLIENT) $(LIBRAD)

bin_PROGRAMS += raderr
raderr_SOURCES = client/raderr.c
raderr_LDADD = $(LIBCLIENT) $(LIBRAD)

# radsubmit in the place of Radiance's rpict and rtrace; found by radsubmit
# --rpict-path
pkglibexec_SCRIPTS = libexec/radd/rpict libexec/radd/rtrace
CLEANFILES += libexec/radd/rpict libexec/radd/rtrace
EXTRA_DIST += client/rpict.in client/rtrace.in

libexec/radd/rpict: client/rpict.in
libexec/radd/rtrace: client/rtrace.in
libexec/radd/rpict libexec/radd/rtrace: Makefile
	$(AM_V_GEN)$(MKDIR_P) $(@D) && \
	$(SED) -e 's|[@]bindir[@]|$(bindir)|g' $(srcdir)/client/$(@F).in \
		>$@.tmp && chmod +x $@.tmp && mv $@.tmp $@
