# The pages.  Their sources name the configuration as if it were in /etc; an
# installed page names where it is.
dist_man_MANS += \
	man/radcoord.8 \
	man/radcoord.conf.5 \
	man/radctl.1 \
	man/radd.8 \
	man/radd.conf.5 \
	man/radd.keys.5 \
	man/radd.stats.5 \
	man/raderr.1 \
	man/radscene.1 \
	man/radsubmit.1 \
	man/radweb.8

install-data-hook:
	cd '$(DESTDIR)$(mandir)' && \
	for page in $(dist_man_MANS); do \
	    page=`basename $$page`; \
	    $(SED) 's|/etc/radd|$(sysconfdir)/radd|g' \
		man$${page##*.}/$$page >.radd-page && \
	    $(INSTALL_DATA) .radd-page man$${page##*.}/$$page || exit 1; \
	done; \
	rm -f .radd-page
