# Shell tests of the programs; client_lib.sh is what they share.
SHELL_TESTS = \
	tests/e2e/cluster_backpressure.sh \
	tests/e2e/cluster_cache.sh \
	tests/e2e/cluster_crash.sh \
	tests/e2e/cluster_descriptors.sh \
	tests/e2e/cluster_error.sh \
	tests/e2e/cluster_fair.sh \
	tests/e2e/cluster_files.sh \
	tests/e2e/cluster_flood.sh \
	tests/e2e/cluster_keys.sh \
	tests/e2e/cluster_passes.sh \
	tests/e2e/cluster_peers.sh \
	tests/e2e/cluster_preview.sh \
	tests/e2e/cluster_sandbox.sh \
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
	tests/e2e/no_memory.sh \
	tests/e2e/other_libm.sh \
	tests/e2e/oversample_memory.sh \
	tests/e2e/owners.sh \
	tests/e2e/points_stream.sh \
	tests/e2e/radctl_check.sh \
	tests/e2e/radctl_here.sh \
	tests/e2e/radctl_lists.sh \
	tests/e2e/radctl_text.sh \
	tests/e2e/radctl_top.sh \
	tests/e2e/radd_first.sh \
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

# Shell tests that also run with sanitized programs.
SANITIZED_E2E = \
	tests/e2e/cluster_garbage.sh \
	tests/e2e/cluster_kill.sh \
	tests/e2e/cluster_restart.sh \
	tests/e2e/cluster_sockets.sh \
	tests/e2e/radscene.sh \
	tests/e2e/submit_embedded.sh

TESTS += $(SANITIZED_E2E) $(SHELL_TESTS)
dist_check_SCRIPTS += $(SANITIZED_E2E) $(SHELL_TESTS)

# what they share
EXTRA_DIST += \
	tests/e2e/chance.sh \
	tests/e2e/client_lib.sh \
	tests/e2e/cluster.sh \
	tests/e2e/faults.sh \
	tests/e2e/small_disk.sh \
	tests/e2e/steer_lib.sh \
	tests/e2e/wire.py
