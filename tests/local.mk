# Unit tests, check_<what>, stand in rooms like those of what they test, and each
# room lists its own; tests of whole programs are shell scripts in e2e.
AM_TESTS_ENVIRONMENT = \
	top_srcdir='$(abs_top_srcdir)'; export top_srcdir; \
	top_builddir='$(abs_top_builddir)'; export top_builddir;

UNIT_TESTS =
LIBUNIT =
if HAVE_CHECK
check_PROGRAMS += $(UNIT_TESTS)
check_LIBRARIES += libunit.a
libunit_a_SOURCES = tests/unit.c
LIBUNIT += libunit.a
TESTS += $(UNIT_TESTS)
endif

# Where nothing else is said the test x is made of x.c alone, and linked with
# these; what it does not call of them is left out.
LDADD = $(LIBUNIT) libclient.a $(LIBDAEMON) $(LIBRAD) $(CHECK_LIBS)

# for the tests of several rooms
noinst_HEADERS = \
	tests/blocked.h \
	tests/closed_mesh.h \
	tests/lambert.h \
	tests/made_picture.h \
	tests/parts.h \
	tests/plan_parts.h \
	tests/scarce.h \
	tests/scratch.h \
	tests/stats_text.h \
	tests/unit.h \
	tests/world.h \
	tests/world_fixture.h \
	tests/world_picture.h
EXTRA_DIST += \
	tests/README.md \
	tests/golden \
	tests/scenes

# what takes longest begins first, or the last minutes have nothing else
include tests/sim/local.mk
include tests/accuracy/local.mk
include tests/soak/local.mk
include tests/fuzz/local.mk
include tests/client/local.mk
include tests/daemon/child/local.mk
include tests/daemon/coord/local.mk
include tests/daemon/ground/local.mk
include tests/daemon/lines/local.mk
include tests/daemon/store/local.mk
include tests/daemon/worker/local.mk
include tests/e2e/local.mk
include tests/net/local.mk
include tests/packages/local.mk
include tests/proto/local.mk
include tests/src/base/local.mk
include tests/src/geom/local.mk
include tests/src/image/local.mk
include tests/src/light/local.mk
include tests/src/passes/local.mk
include tests/src/picture/local.mk
include tests/src/scene/local.mk
include tests/src/shade/local.mk
include tests/tools/local.mk
include tests/web/local.mk

# Tests whose code runs in threads: once more under ThreadSanitizer.
THREAD_TESTS = \
	tests/daemon/child/check_estimate \
	tests/daemon/child/check_pool \
	tests/daemon/child/check_pool_tiles \
	tests/daemon/child/check_team \
	tests/daemon/child/check_team_lend \
	tests/daemon/child/check_team_member \
	tests/daemon/ground/check_task \
	tests/net/check_fair \
	tests/src/light/check_ambcache \
	tests/src/light/check_ambient \
	tests/src/light/check_bright \
	tests/src/light/check_smooth \
	tests/src/picture/check_facts

SANITIZED_MORE = \
	tests/fuzz/replay.sh \
	tests/soak/pairs.sh

# Tests of rights, of what is kept from others and of what the system refuses,
# where root goes other ways than an ordinary user; the longest first.
ROOT_TESTS = \
	tests/e2e/radweb_page.sh \
	tests/e2e/coord_full.sh \
	tests/e2e/slurm.sh \
	tests/e2e/cluster_sandbox.sh \
	tests/e2e/radctl_lists.sh \
	tests/daemon/child/check_sandbox \
	tests/daemon/coord/check_owner \
	tests/daemon/ground/check_files \
	tests/daemon/ground/check_shelf \
	tests/daemon/store/check_store \
	tests/net/check_credentials \
	tests/net/check_keyfile \
	tests/e2e/cluster_keys.sh \
	tests/e2e/cluster_sockets.sh \
	tests/e2e/daemon_settings.sh \
	tests/e2e/enroll.sh \
	tests/e2e/kept_jobs.sh \
	tests/e2e/keys.sh \
	tests/e2e/launch_real.sh \
	tests/e2e/owners.sh \
	tests/e2e/radctl_check.sh \
	tests/e2e/radctl_here.sh \
	tests/e2e/radd_refused.sh \
	tests/e2e/radd_shortage.sh \
	tests/e2e/state_damage.sh \
	tests/e2e/submit_bad_input.sh \
	tests/e2e/submit_outputs.sh \
	tests/e2e/systemd_units.sh

# Each make runs the recipe of config.h, on which all programs depend: a test
# that did not wait for it, too, would begin before the longest ones.
$(TEST_LOGS): config.h

.PHONY: check-root check-sanitized check-threads
check-root:
	$(MAKE) $(AM_MAKEFLAGS) check TESTS='$(ROOT_TESTS)'
check-sanitized:
	$(MAKE) $(AM_MAKEFLAGS) check \
		TESTS='$(SANITIZED_E2E) $(SANITIZED_MORE) $(UNIT_TESTS)'
check-threads:
	$(MAKE) $(AM_MAKEFLAGS) check \
		check_PROGRAMS='$(TOOLS) $(THREAD_TESTS)' \
		TESTS='$(SANITIZED_E2E) $(THREAD_TESTS)'

# The floor plan of doc/architecture.md against the code.
TESTS += tests/doors.sh
dist_check_SCRIPTS += tests/doors.sh
