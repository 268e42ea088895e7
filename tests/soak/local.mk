# Hours of trouble: `make soak` runs every script named here, one after the
# other, and goes on after one that fails.  Their short forms are tests of
# `make check`; how long each goes on is set by the variables that it names at
# its top.
SOAK = \
	tests/soak/ambcache.sh \
	tests/soak/disaster.sh \
	tests/soak/garbage.sh \
	tests/soak/kills.sh \
	tests/soak/pairs.sh \
	tests/soak/partition.sh \
	tests/soak/slow.sh \
	tests/soak/standstill.sh \
	tests/soak/storm.sh \
	tests/soak/userflood.sh

EXTRA_DIST += tests/soak/pairs.py

dist_check_SCRIPTS += $(SOAK)
# a minute of them
TESTS += $(SOAK)

.PHONY: soak
soak: all-am $(check_PROGRAMS) $(check_DATA)
	@failed=; for script in $(SOAK); do \
		echo "== $$script"; \
		RADD_SOAK=long top_srcdir='$(top_srcdir)' \
		top_builddir='$(top_builddir)' \
		$(SHELL) $(top_srcdir)/$$script </dev/null || \
			failed="$$failed $$script"; \
	done; \
	test -z "$$failed" || { echo "FAILED:$$failed"; exit 1; }
