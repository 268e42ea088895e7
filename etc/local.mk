# samples of settings, systemd's units and user, completion for bash
EXTRA_DIST += \
	etc/radcoord.conf \
	etc/radcoord.service.in \
	etc/radd.completion \
	etc/radd.conf \
	etc/radd.service.in \
	etc/radd.sysusers \
	etc/radsubmit.conf \
	etc/radweb.conf \
	etc/radweb.service.in \
	etc/slurm/radd.sbatch

# samples, where they overwrite nobody's settings
sampledir = $(docdir)/examples
dist_sample_DATA = \
	etc/radcoord.conf \
	etc/radd.conf \
	etc/radsubmit.conf \
	etc/radweb.conf \
	etc/slurm/radd.sbatch

systemdsystemunit_DATA = \
	etc/radcoord.service \
	etc/radd.service \
	etc/radweb.service
CLEANFILES += $(systemdsystemunit_DATA)

# paths are make's to know, not configure's
%.service: %.service.in Makefile
	$(AM_V_GEN)$(MKDIR_P) $(@D) && \
	$(SED) -e 's|[@]sbindir[@]|$(sbindir)|g' \
		-e 's|[@]sysconfdir[@]|$(sysconfdir)|g' $< >$@.tmp && mv $@.tmp $@

install-data-local: install-sysusers install-completion install-settings
uninstall-local:
	rmdir '$(DESTDIR)$(sysconfdir)/radd' 2>/dev/null || :
	rm -f '$(DESTDIR)$(prefix)/lib/sysusers.d/radd.conf' \
		'$(DESTDIR)$(datadir)/bash-completion/completions/radd'
	for p in $(COMPLETED); do \
	    rm -f "$(DESTDIR)$(datadir)/bash-completion/completions/$$p"; \
	done

# systemd's folder wants another name than the file has here
.PHONY: install-sysusers install-completion install-settings
install-sysusers:
	$(MKDIR_P) '$(DESTDIR)$(prefix)/lib/sysusers.d'
	$(INSTALL_DATA) $(srcdir)/etc/radd.sysusers \
		'$(DESTDIR)$(prefix)/lib/sysusers.d/radd.conf'

# where settings and keys are looked for; what is in it stays
install-settings:
	$(MKDIR_P) '$(DESTDIR)$(sysconfdir)/radd'

# one file for all programs, found under the name of each
COMPLETED = radcoord radctl raderr radscene radsubmit radweb
install-completion:
	$(MKDIR_P) '$(DESTDIR)$(datadir)/bash-completion/completions'
	$(INSTALL_DATA) $(srcdir)/etc/radd.completion \
		'$(DESTDIR)$(datadir)/bash-completion/completions/radd'
	for p in $(COMPLETED); do \
	    ln -sf radd \
		"$(DESTDIR)$(datadir)/bash-completion/completions/$$p"; \
	done
