# The Debian packages in clean trees of a release, SUITE=bookworm if not named; for
# root.
EXTRA_DIST += tests/packages/booted.sh tests/packages/packages.sh \
	tests/packages/room.rad
.PHONY: check-packages
check-packages: dist
	$(srcdir)/tests/packages/packages.sh $(distdir).tar.xz $(SUITE)
