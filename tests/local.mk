# One program per module, named check_<module>; shell tests under e2e/.
AM_TESTS_ENVIRONMENT = \
	top_srcdir='$(abs_top_srcdir)'; export top_srcdir; \
	top_builddir='$(abs_top_builddir)'; export top_builddir; \
	CK_DEFAULT_TIMEOUT=$${CK_DEFAULT_TIMEOUT:-600}; \
	export CK_DEFAULT_TIMEOUT;

# for the tests of several rooms
noinst_HEADERS = \
	tests/closed_mesh.h \
	tests/lambert.h \
	tests/made_picture.h \
	tests/parts.h \
	tests/scratch.h \
	tests/unit.h \
	tests/world.h

UNIT_TESTS =

include tests/client/local.mk
include tests/daemon/child/local.mk
include tests/daemon/coord/local.mk
include tests/daemon/ground/local.mk
include tests/daemon/lines/local.mk
include tests/daemon/store/local.mk
include tests/daemon/worker/local.mk
include tests/net/local.mk
include tests/proto/local.mk
include tests/sim/local.mk
include tests/src/base/local.mk
include tests/src/geom/local.mk
include tests/src/image/local.mk
include tests/src/light/local.mk
include tests/src/passes/local.mk
include tests/src/picture/local.mk
include tests/src/scene/local.mk
include tests/src/shade/local.mk
include tests/web/local.mk

if HAVE_CHECK
check_PROGRAMS += $(UNIT_TESTS)
TESTS += $(UNIT_TESTS)
endif

# Where nothing else is said the test x is made of x.c alone, and linked with
# these; what it does not call of them is left out.
LDADD = libclient.a $(LIBDAEMON) $(LIBRAD) $(CHECK_LIBS)

# Shell tests of the programs; client_lib.sh is what they share.
SHELL_TESTS = \
	tests/e2e/cluster_backpressure.sh \
	tests/e2e/cluster_cache.sh \
	tests/e2e/cluster_crash.sh \
	tests/e2e/cluster_descriptors.sh \
	tests/e2e/cluster_error.sh \
	tests/e2e/cluster_files.sh \
	tests/e2e/cluster_flood.sh \
	tests/e2e/cluster_keys.sh \
	tests/e2e/cluster_passes.sh \
	tests/e2e/cluster_peers.sh \
	tests/e2e/cluster_preview.sh \
	tests/e2e/cluster_sandbox.sh \
	tests/e2e/cluster_sockets.sh \
	tests/e2e/completion.sh \
	tests/e2e/coord_frames.sh \
	tests/e2e/coord_full.sh \
	tests/e2e/daemon_settings.sh \
	tests/e2e/enroll.sh \
	tests/e2e/fetch_spoilt.sh \
	tests/e2e/glow_rays.sh \
	tests/e2e/identity.sh \
	tests/e2e/identity_faults.sh \
	tests/e2e/kept_jobs.sh \
	tests/e2e/keys.sh \
	tests/e2e/launch.sh \
	tests/e2e/launch_real.sh \
	tests/e2e/manpages.sh \
	tests/e2e/materials.sh \
	tests/e2e/other_libm.sh \
	tests/e2e/oversample_memory.sh \
	tests/e2e/owners.sh \
	tests/e2e/points_stream.sh \
	tests/e2e/radctl_check.sh \
	tests/e2e/radctl_here.sh \
	tests/e2e/radctl_lists.sh \
	tests/e2e/radctl_text.sh \
	tests/e2e/radctl_top.sh \
	tests/e2e/radd_hours.sh \
	tests/e2e/radd_refused.sh \
	tests/e2e/radd_shortage.sh \
	tests/e2e/raderr.sh \
	tests/e2e/radweb.sh \
	tests/e2e/radweb_page.sh \
	tests/e2e/reuse.sh \
	tests/e2e/rpict_path.sh \
	tests/e2e/rtrace_path.sh \
	tests/e2e/sim_windows.sh \
	tests/e2e/slurm.sh \
	tests/e2e/state_damage.sh \
	tests/e2e/stats.sh \
	tests/e2e/steer.sh \
	tests/e2e/steer_first.sh \
	tests/e2e/submit_ambient.sh \
	tests/e2e/submit_bad_input.sh \
	tests/e2e/submit_bands.sh \
	tests/e2e/submit_detach.sh \
	tests/e2e/submit_dry_run.sh \
	tests/e2e/submit_error.sh \
	tests/e2e/submit_false_colour.sh \
	tests/e2e/submit_header.sh \
	tests/e2e/submit_interrupt.sh \
	tests/e2e/submit_left.sh \
	tests/e2e/submit_limits.sh \
	tests/e2e/submit_outputs.sh \
	tests/e2e/submit_oversample.sh \
	tests/e2e/submit_parts.sh \
	tests/e2e/submit_points.sh \
	tests/e2e/submit_rif.sh \
	tests/e2e/submit_tone.sh \
	tests/e2e/submit_walk.sh \
	tests/e2e/systemd_units.sh \
	tests/e2e/versions.sh \
	tests/e2e/words.sh
dist_check_SCRIPTS += $(SHELL_TESTS)
TESTS += $(SHELL_TESTS)
EXTRA_DIST += \
	tests/e2e/chance.sh \
	tests/e2e/client_lib.sh \
	tests/e2e/cluster.sh \
	tests/e2e/steer_lib.sh \
	tests/e2e/faults.sh \
	tests/scenes \
	tests/golden

# Tests whose code runs in threads: once more under ThreadSanitizer.
THREAD_TESTS = \
	tests/src/light/check_ambcache \
	tests/src/light/check_ambient \
	tests/src/light/check_bright \
	tests/src/picture/check_estimate \
	tests/src/picture/check_facts \
	tests/net/check_fair \
	tests/daemon/child/check_pool \
	tests/src/light/check_smooth \
	tests/daemon/ground/check_task \
	tests/daemon/child/check_team \
	tests/daemon/child/check_team_lend \
	tests/daemon/child/check_team_member
# Shell tests that also run with sanitized programs.
SANITIZED_E2E = \
	tests/e2e/cluster_garbage.sh \
	tests/e2e/cluster_kill.sh \
	tests/e2e/cluster_restart.sh \
	tests/e2e/radscene.sh \
	tests/e2e/submit_embedded.sh

TESTS += $(SANITIZED_E2E)
dist_check_SCRIPTS += $(SANITIZED_E2E)

SANITIZED_MORE = \
	tests/fuzz/replay.sh \
	tests/soak/pairs.sh

# Tests of rights, of what is kept from others and of what the system refuses,
# where root goes other ways than an ordinary user.
ROOT_TESTS = \
	tests/net/check_credentials \
	tests/daemon/ground/check_files \
	tests/net/check_keyfile \
	tests/daemon/coord/check_owner \
	tests/daemon/child/check_sandbox \
	tests/daemon/ground/check_shelf \
	tests/daemon/store/check_store \
	tests/e2e/cluster_keys.sh \
	tests/e2e/cluster_sandbox.sh \
	tests/e2e/cluster_sockets.sh \
	tests/e2e/coord_full.sh \
	tests/e2e/daemon_settings.sh \
	tests/e2e/enroll.sh \
	tests/e2e/kept_jobs.sh \
	tests/e2e/keys.sh \
	tests/e2e/launch_real.sh \
	tests/e2e/owners.sh \
	tests/e2e/radctl_check.sh \
	tests/e2e/radctl_here.sh \
	tests/e2e/radctl_lists.sh \
	tests/e2e/radd_refused.sh \
	tests/e2e/radd_shortage.sh \
	tests/e2e/radweb_page.sh \
	tests/e2e/slurm.sh \
	tests/e2e/state_damage.sh \
	tests/e2e/submit_bad_input.sh \
	tests/e2e/submit_outputs.sh \
	tests/e2e/systemd_units.sh

.PHONY: check-root check-sanitized check-threads
check-root:
	$(MAKE) $(AM_MAKEFLAGS) check TESTS='$(ROOT_TESTS)'
check-sanitized:
	$(MAKE) $(AM_MAKEFLAGS) check \
		TESTS='$(UNIT_TESTS) $(SANITIZED_MORE) $(SANITIZED_E2E)'
check-threads:
	$(MAKE) $(AM_MAKEFLAGS) check \
		check_PROGRAMS='$(TOOLS) $(THREAD_TESTS)' \
		TESTS='$(THREAD_TESTS) $(SANITIZED_E2E)'

# The floor plan of doc/architecture.md against the code.
TESTS += tests/doors.sh
dist_check_SCRIPTS += tests/doors.sh

# The Debian packages in clean trees of Debian; for root.
EXTRA_DIST += tests/packages/booted.sh tests/packages/packages.sh \
	tests/packages/room.rad
.PHONY: check-packages
check-packages: dist
	$(srcdir)/tests/packages/packages.sh $(distdir).tar.xz

include tests/tools/local.mk
