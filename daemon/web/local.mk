# radweb, the daemon that shows a cluster: a library for its tests, and its main
noinst_LIBRARIES += libweb.a
libweb_a_CPPFLAGS = $(AM_CPPFLAGS) -DSYSCONFDIR='"$(sysconfdir)"' \
	-DASSETS_FOLDER='"$(srcdir)/daemon/web"'
libweb_a_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(JANSSON_CFLAGS) \
	$(CRYPTO_CFLAGS) $(MICROHTTPD_CFLAGS) $(SECCOMP_CFLAGS)
libweb_a_SOURCES = \
	daemon/web/answer.c \
	daemon/web/answer.h \
	daemon/web/assets.c \
	daemon/web/assets.h \
	daemon/web/chart.c \
	daemon/web/chart.h \
	daemon/web/confine.c \
	daemon/web/confine.h \
	daemon/web/events.c \
	daemon/web/page.c \
	daemon/web/page.h \
	daemon/web/page_home.c \
	daemon/web/page_job.c \
	daemon/web/radweb_auth.c \
	daemon/web/radweb_conf.c \
	daemon/web/radweb_impl.h \
	daemon/web/report.c \
	daemon/web/report.h \
	daemon/web/route.c \
	daemon/web/serve.c \
	daemon/web/serve.h

WEB_ASSETS = \
	daemon/web/icon.svg \
	daemon/web/page.js \
	daemon/web/style.css
EXTRA_DIST += $(WEB_ASSETS)

# the assembler takes the files in
daemon/web/libweb_a-assets.$(OBJEXT): $(WEB_ASSETS)

radweb_SOURCES = daemon/web/radweb.c
