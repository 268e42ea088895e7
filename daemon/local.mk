# libdaemon, the machines behind the daemons
noinst_LIBRARIES += libdaemon.a
libdaemon_a_CPPFLAGS = $(AM_CPPFLAGS)
libdaemon_a_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(SECCOMP_CFLAGS) $(JANSSON_CFLAGS) \
	$(SQLITE_CFLAGS)
libdaemon_a_SOURCES =
include daemon/ground/local.mk
include daemon/machine/local.mk
include daemon/partition/local.mk
include daemon/filling/local.mk
include daemon/sched/local.mk
include daemon/users/local.mk
include daemon/jobs/local.mk
include daemon/desk/local.mk
include daemon/lines/local.mk
include daemon/registry/local.mk
include daemon/front/local.mk
include daemon/shell/local.mk
include daemon/radcoord/local.mk
include daemon/files/local.mk
include daemon/store/local.mk
include daemon/folder/local.mk
include daemon/journal/local.mk
include daemon/worker/local.mk
include daemon/radd/local.mk
include daemon/child/local.mk
include daemon/pool/local.mk
include daemon/team/local.mk
include daemon/strict/local.mk
include daemon/web/local.mk
include daemon/observer/local.mk

# what a program that uses libdaemon links with, before $(LIBRAD)
LIBDAEMON = libdaemon.a $(LIBNET) $(SECCOMP_LIBS) $(JANSSON_LIBS) \
	$(SQLITE_LIBS)

sbin_PROGRAMS += radcoord radd radweb
radcoord_CPPFLAGS = $(AM_CPPFLAGS) -DSYSCONFDIR='"$(sysconfdir)"'
radcoord_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
radcoord_LDADD = $(LIBDAEMON) $(LIBRAD)
radd_CPPFLAGS = $(AM_CPPFLAGS) -DSYSCONFDIR='"$(sysconfdir)"'
radd_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
radd_LDADD = $(LIBDAEMON) $(LIBRAD)
radweb_CPPFLAGS = $(AM_CPPFLAGS)
radweb_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(JANSSON_CFLAGS) \
	$(MICROHTTPD_CFLAGS)
radweb_LDADD = libweb.a $(LIBDAEMON) $(LIBRAD) $(MICROHTTPD_LIBS)
