# What the clients share, as a library so that tests can link it.
noinst_LIBRARIES += libclient.a
libclient_a_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_SYSCONFDIR='"$(sysconfdir)"' \
	-DRADD_LIBEXECDIR='"$(pkglibexecdir)"'
libclient_a_CFLAGS = $(AM_CFLAGS) $(JANSSON_CFLAGS) \
	$(UV_CFLAGS)
libclient_a_SOURCES = \
	client/ambfile.c \
	client/ambfile.h \
	client/amblist.c \
	client/amblist.h \
	client/apart.c \
	client/apart.h \
	client/cargo.c \
	client/cargo.h \
	client/command.c \
	client/command.h \
	client/compile.c \
	client/compile.h \
	client/costs.c \
	client/costs.h \
	client/dryrun.c \
	client/dryrun.h \
	client/eta.c \
	client/eta.h \
	client/expose.c \
	client/expose.h \
	client/fetch.c \
	client/fetch.h \
	client/figure.c \
	client/figure.h \
	client/foresee.c \
	client/foresee.h \
	client/frames.c \
	client/frames.h \
	client/inputs.c \
	client/inputs.h \
	client/jobspec.c \
	client/jobspec.h \
	client/keyctl.c \
	client/keyctl.h \
	client/link.c \
	client/link.h \
	client/local.c \
	client/local.h \
	client/origin.c \
	client/origin.h \
	client/outname.c \
	client/outname.h \
	client/paths.c \
	client/paths.h \
	client/picfile.c \
	client/picfile.h \
	client/progress.c \
	client/progress.h \
	client/quality.c \
	client/quality.h \
	client/rays.c \
	client/rays.h \
	client/records.c \
	client/records.h \
	client/rescue.c \
	client/rescue.h \
	client/rif.c \
	client/rif.h \
	client/rif_rules.c \
	client/rif_rules.h \
	client/rif_view.c \
	client/rif_view.h \
	client/rifjob.c \
	client/rifjob.h \
	client/show.c \
	client/show.h \
	client/submit.c \
	client/submit.h \
	client/submit_options.c \
	client/submit_options.h \
	client/table.c \
	client/table.h \
	client/target.c \
	client/target.h \
	client/tell.c \
	client/tell.h \
	client/trial.c \
	client/trial.h \
	client/warning.c \
	client/warning.h \
	client/words.c \
	client/words.h \
	daemon/ambshare.c \
	daemon/ambshare.h \
	daemon/wordlist.c \
	daemon/wordlist.h

# what a client links with, before LIBRAD
LIBCLIENT = libclient.a $(LIBPROTO) $(JANSSON_LIBS) $(UV_LIBS)

bin_PROGRAMS += radscene
radscene_SOURCES = client/radscene.c
radscene_LDADD = $(LIBCLIENT) $(LIBRAD)

bin_PROGRAMS += radctl radsubmit
radctl_SOURCES = \
	client/ctl.c \
	client/ctl.h \
	client/ctl_admin.c \
	client/ctl_job.c \
	client/ctl_list.c \
	client/ctl_words.c \
	client/radctl.c
radctl_CFLAGS = $(AM_CFLAGS) $(JANSSON_CFLAGS) $(UV_CFLAGS)
radctl_LDADD = $(LIBCLIENT) $(LIBDAEMON) $(LIBRAD)
radsubmit_SOURCES = \
	client/program.h \
	client/program_files.c \
	client/program_say.c \
	client/radsubmit.c
radsubmit_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_LIBEXECDIR='"$(pkglibexecdir)"'
radsubmit_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
radsubmit_LDADD = $(LIBCLIENT) $(LIBRAD)

bin_PROGRAMS += raderr
raderr_SOURCES = client/raderr.c
raderr_LDADD = $(LIBCLIENT) $(LIBRAD)

# radsubmit in the place of Radiance's rpict; found by radsubmit --rpict-path
pkglibexec_SCRIPTS = libexec/radd/rpict
CLEANFILES += libexec/radd/rpict
EXTRA_DIST += client/rpict.in

libexec/radd/rpict: client/rpict.in Makefile
	$(AM_V_GEN)$(MKDIR_P) $(@D) && \
	$(SED) -e 's|[@]bindir[@]|$(bindir)|g' $(srcdir)/client/rpict.in \
		>$@.tmp && chmod +x $@.tmp && mv $@.tmp $@
