# One program per module, named check_<module>; shell tests under e2e/.
AM_TESTS_ENVIRONMENT = \
	top_srcdir='$(abs_top_srcdir)'; export top_srcdir; \
	top_builddir='$(abs_top_builddir)'; export top_builddir; \
	CK_DEFAULT_TIMEOUT=$${CK_DEFAULT_TIMEOUT:-600}; \
	export CK_DEFAULT_TIMEOUT;

UNIT_TESTS = \
	tests/check_ambcache \
	tests/check_ambfile \
	tests/check_ambient \
	tests/check_bright \
	tests/check_ambshare \
	tests/check_aniso \
	tests/check_antimatter \
	tests/check_ashik \
	tests/check_base \
	tests/check_text \
	tests/check_brdf \
	tests/check_bsdf \
	tests/check_bundle \
	tests/check_bvh \
	tests/check_calc \
	tests/check_client \
	tests/check_compile \
	tests/check_conf \
	tests/check_conn \
	tests/check_coord_conns \
	tests/check_coord_faults \
	tests/check_coord_jobs \
	tests/check_coord_passes \
	tests/check_reuse \
	tests/check_coord_order \
	tests/check_listing \
	tests/check_coord_rows \
	tests/check_seeding \
	tests/check_costs \
	tests/check_credentials \
	tests/check_data \
	tests/check_estimate \
	tests/check_eta \
	tests/check_facts \
	tests/check_fair \
	tests/check_falsecolour \
	tests/check_filter \
	tests/check_font \
	tests/check_fprism \
	tests/check_frame \
	tests/check_func \
	tests/check_gate \
	tests/check_geom \
	tests/check_handoff \
	tests/check_back \
	tests/check_owner \
	tests/check_coarse \
	tests/check_shelf \
	tests/check_spectrum \
	tests/check_states \
	tests/check_parked \
	tests/check_yield \
	tests/check_balance \
	tests/check_lending \
	tests/check_twins \
	tests/check_survey \
	tests/check_hdr \
	tests/check_hostile \
	tests/check_cache \
	tests/check_idle \
	tests/check_known \
	tests/check_keyfile \
	tests/check_link \
	tests/check_message \
	tests/check_doubt \
	tests/check_metric \
	tests/check_mirror \
	tests/check_mist \
	tests/check_octfile \
	tests/check_octree \
	tests/check_params \
	tests/check_origin \
	tests/check_parse \
	tests/check_partition \
	tests/check_points \
	tests/check_place \
	tests/check_pool \
	tests/check_prism \
	tests/check_quincunx \
	tests/check_quota \
	tests/check_ray \
	tests/check_rays \
	tests/check_rif \
	tests/check_ring \
	tests/check_sample \
	tests/check_sandbox \
	tests/check_passes \
	tests/check_refine \
	tests/check_seed \
	tests/check_seeds \
	tests/check_shade \
	tests/check_shell \
	tests/check_sim \
	tests/check_smooth \
	tests/check_source \
	tests/check_store \
	tests/check_strict \
	tests/check_strict_loan \
	tests/check_strict_pass \
	tests/check_strict_rank \
	tests/check_strict_unit \
	tests/check_submit \
	tests/check_table \
	tests/check_top \
	tests/check_task \
	tests/check_team \
	tests/check_team_lend \
	tests/check_team_member \
	tests/check_tls \
	tests/check_tone \
	tests/check_view \
	tests/check_watch \
	tests/check_web \
	tests/check_wgmd \
	tests/check_wild \
	tests/check_wire \
	tests/check_worker

if HAVE_CHECK
check_PROGRAMS += $(UNIT_TESTS)
TESTS += $(UNIT_TESTS)
endif

# The renderer alone, the reference for the cluster.
check_PROGRAMS += tests/seqpict
tests_seqpict_SOURCES = tests/seqpict.c
tests_seqpict_LDADD = $(LIBCLIENT) $(LIBRAD)

# What a tone curve makes of a picture, and what a PNG holds.
check_PROGRAMS += tests/shown
tests_shown_SOURCES = tests/shown.c
tests_shown_CFLAGS = $(AM_CFLAGS) $(PNG_CFLAGS)
tests_shown_LDADD = $(LIBCLIENT) $(LIBRAD)

UNIT_LIBS = $(LIBRAD) $(CHECK_LIBS)

tests_check_ambcache_SOURCES = tests/check_ambcache.c tests/unit.h tests/world.h
tests_check_ambcache_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_ambcache_LDFLAGS = $(AM_LDFLAGS) -Wl,--wrap=malloc \
	-Wl,--wrap=calloc -Wl,--wrap=realloc -Wl,--wrap=aligned_alloc
tests_check_ambcache_LDADD = $(UNIT_LIBS)

tests_check_ambfile_SOURCES = tests/check_ambfile.c tests/unit.h tests/world.h
tests_check_ambfile_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_ambfile_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_bright_SOURCES = tests/check_bright.c tests/unit.h tests/world.h
tests_check_bright_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_bright_LDADD = $(UNIT_LIBS)

tests_check_ambient_SOURCES = tests/check_ambient.c tests/lambert.h tests/unit.h \
	tests/world.h
tests_check_ambient_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_ambient_LDADD = $(UNIT_LIBS)

tests_check_aniso_SOURCES = tests/check_aniso.c tests/square.h tests/suns.h \
	tests/unit.h tests/world.h
tests_check_aniso_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_aniso_LDADD = $(UNIT_LIBS)

tests_check_ashik_SOURCES = tests/check_ashik.c tests/square.h tests/suns.h \
	tests/unit.h tests/world.h
tests_check_ashik_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_ashik_LDADD = $(UNIT_LIBS)

tests_check_text_SOURCES = tests/check_text.c tests/unit.h
tests_check_text_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_text_LDADD = $(UNIT_LIBS)
tests_check_base_SOURCES = tests/check_base.c tests/unit.h
tests_check_base_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_base_LDADD = $(UNIT_LIBS)

tests_check_brdf_SOURCES = tests/check_brdf.c tests/square.h tests/suns.h \
	tests/unit.h tests/world.h
tests_check_brdf_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_brdf_LDADD = $(UNIT_LIBS)

tests_check_bsdf_SOURCES = tests/check_bsdf.c tests/unit.h tests/world.h
tests_check_bsdf_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_bsdf_LDADD = $(UNIT_LIBS)

tests_check_bundle_SOURCES = tests/check_bundle.c tests/unit.h
tests_check_bundle_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_bundle_LDADD = $(UNIT_LIBS)

tests_check_bvh_SOURCES = tests/check_bvh.c tests/geom_scene.h tests/unit.h
tests_check_bvh_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_bvh_LDADD = $(UNIT_LIBS)

tests_check_calc_SOURCES = tests/check_calc.c tests/unit.h
tests_check_calc_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_calc_LDADD = $(UNIT_LIBS)

tests_check_spectrum_SOURCES = tests/check_spectrum.c tests/unit.h
tests_check_spectrum_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_spectrum_LDADD = $(UNIT_LIBS)

tests_check_data_SOURCES = tests/check_data.c tests/unit.h tests/world.h
tests_check_data_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_data_LDADD = $(UNIT_LIBS)

tests_check_top_SOURCES = tests/check_top.c tests/unit.h
tests_check_top_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_top_LDADD = $(LIBCLIENT) $(UNIT_LIBS)
tests_check_table_SOURCES = tests/check_table.c tests/unit.h tests/world.h
tests_check_table_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_table_LDADD = $(UNIT_LIBS)

tests_check_func_SOURCES = tests/check_func.c tests/unit.h tests/world.h
tests_check_func_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_func_LDADD = $(UNIT_LIBS)

tests_check_geom_SOURCES = tests/check_geom.c tests/closed_mesh.h \
	tests/geom_scene.h tests/unit.h
tests_check_geom_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_geom_LDADD = $(UNIT_LIBS)

tests_check_place_SOURCES = tests/check_place.c tests/parts.h tests/unit.h \
	tests/world.h
tests_check_place_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_place_LDADD = $(UNIT_LIBS)

tests_check_params_SOURCES = tests/check_params.c tests/unit.h
tests_check_params_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_params_LDADD = $(UNIT_LIBS)

tests_check_view_SOURCES = tests/check_view.c tests/unit.h
tests_check_view_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_view_LDADD = $(UNIT_LIBS)

tests_check_eta_SOURCES = tests/check_eta.c tests/unit.h
tests_check_eta_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_eta_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_facts_SOURCES = tests/check_facts.c tests/unit.h
tests_check_facts_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_facts_LDADD = $(UNIT_LIBS)

tests_check_filter_SOURCES = tests/check_filter.c tests/unit.h
tests_check_filter_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_filter_LDADD = $(UNIT_LIBS)

tests_check_font_SOURCES = tests/check_font.c tests/unit.h
tests_check_font_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_font_LDADD = $(UNIT_LIBS)

tests_check_hdr_SOURCES = tests/check_hdr.c tests/unit.h
tests_check_hdr_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_hdr_LDADD = $(UNIT_LIBS)

tests_check_origin_SOURCES = tests/check_origin.c tests/unit.h
tests_check_origin_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_origin_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_client_SOURCES = tests/check_client.c tests/unit.h
tests_check_client_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_client_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_link_SOURCES = tests/check_link.c tests/unit.h
tests_check_link_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_link_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_rif_SOURCES = tests/check_rif.c tests/unit.h
tests_check_rif_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_rif_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_costs_SOURCES = tests/check_costs.c tests/unit.h
tests_check_costs_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_costs_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_compile_SOURCES = tests/check_compile.c tests/unit.h
tests_check_compile_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_compile_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_submit_SOURCES = tests/check_submit.c tests/unit.h
tests_check_submit_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(UV_CFLAGS)
tests_check_submit_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_ray_SOURCES = tests/check_ray.c tests/unit.h tests/world.h
tests_check_ray_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_ray_LDADD = $(UNIT_LIBS)

tests_check_rays_SOURCES = tests/check_rays.c tests/unit.h
tests_check_rays_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_rays_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_shade_SOURCES = tests/check_shade.c tests/suns.h tests/unit.h tests/world.h
tests_check_shade_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_shade_LDADD = $(UNIT_LIBS)

tests_check_antimatter_SOURCES = tests/check_antimatter.c tests/parts.h tests/unit.h \
	tests/world.h
tests_check_antimatter_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_antimatter_LDADD = $(UNIT_LIBS)

tests_check_hostile_SOURCES = tests/check_hostile.c tests/unit.h tests/wild.h \
	tests/world.h
tests_check_hostile_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_hostile_LDADD = $(UNIT_LIBS)

tests_check_mist_SOURCES = tests/check_mist.c tests/unit.h tests/world.h
tests_check_mist_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_mist_LDADD = $(UNIT_LIBS)

tests_check_mirror_SOURCES = tests/check_mirror.c tests/unit.h \
	tests/world.h
tests_check_mirror_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_mirror_LDADD = $(UNIT_LIBS)

tests_check_sample_SOURCES = tests/check_sample.c tests/lambert.h tests/unit.h
tests_check_sample_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_sample_LDADD = $(UNIT_LIBS)

tests_check_smooth_SOURCES = tests/check_smooth.c tests/unit.h
tests_check_smooth_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_smooth_LDADD = $(UNIT_LIBS)

tests_check_source_SOURCES = tests/check_source.c tests/lambert.h tests/unit.h \
	tests/world.h
tests_check_source_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_source_LDADD = $(UNIT_LIBS)

tests_check_octfile_SOURCES = tests/check_octfile.c tests/unit.h
tests_check_octfile_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_octfile_LDADD = $(UNIT_LIBS)

tests_check_octree_SOURCES = tests/check_octree.c tests/unit.h
tests_check_octree_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_octree_LDADD = $(UNIT_LIBS)

tests_check_parse_SOURCES = tests/check_parse.c tests/unit.h
tests_check_parse_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_parse_LDADD = $(UNIT_LIBS)

tests_check_prism_SOURCES = tests/check_prism.c tests/unit.h tests/world.h
tests_check_prism_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_prism_LDADD = $(UNIT_LIBS)

tests_check_quincunx_SOURCES = tests/check_quincunx.c tests/unit.h
tests_check_quincunx_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_quincunx_LDADD = $(UNIT_LIBS)

# sends bytes to a socket, for the shell tests
check_PROGRAMS += tests/flood
tests_flood_SOURCES = tests/flood.c
tests_flood_LDADD = $(LIBDAEMON) $(LIBRAD)

check_PROGRAMS += tests/poke
tests_poke_SOURCES = tests/poke.c
tests_poke_LDADD = $(LIBDAEMON) $(LIBRAD)

# what may befall the coordinator, for LD_PRELOAD: no program is linked with it
check_DATA += tests/disaster.so
EXTRA_DIST += tests/disaster.c
CLEANFILES += tests/disaster.so
tests/disaster.so: $(top_srcdir)/tests/disaster.c config.h
	$(AM_V_CC)$(MKDIR_P) tests && \
	$(CC) -std=gnu11 -O1 -g -Wall -Wextra $(DEFS) $(DEFAULT_INCLUDES) \
		-shared -fPIC -o $@ $(top_srcdir)/tests/disaster.c

# radd with the hooks of tests/hook.h: not to be installed
check_PROGRAMS += tests/radd-hooked
tests_radd_hooked_SOURCES = daemon/radd/radd.c daemon/child/pool_unit.c tests/hook.c \
	tests/hook.h
tests_radd_hooked_CPPFLAGS = $(radd_CPPFLAGS) -DRADD_TEST_HOOKS
tests_radd_hooked_CFLAGS = $(radd_CFLAGS)
tests_radd_hooked_LDADD = $(radd_LDADD)

# a bad connection, for the shell tests
check_PROGRAMS += tests/proxy
tests_proxy_SOURCES = tests/proxy.c
tests_proxy_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
tests_proxy_LDADD = $(LIBDAEMON) $(LIBRAD)

# runs a program as a unit of systemd would
check_PROGRAMS += tests/confine
tests_confine_SOURCES = tests/confine.c
tests_confine_CFLAGS = $(AM_CFLAGS) $(SECCOMP_CFLAGS)
tests_confine_LDADD = $(SECCOMP_LIBS)

# Shell tests of the programs; client_lib.sh is what they share.
dist_check_SCRIPTS += \
	tests/e2e/cluster_backpressure.sh \
	tests/e2e/cluster_crash.sh \
	tests/e2e/completion.sh \
	tests/e2e/enroll.sh \
	tests/e2e/daemon_settings.sh \
	tests/e2e/coord_frames.sh \
	tests/e2e/coord_full.sh \
	tests/e2e/cluster_cache.sh \
	tests/e2e/cluster_files.sh \
	tests/e2e/cluster_descriptors.sh \
	tests/e2e/cluster_flood.sh \
	tests/e2e/cluster_keys.sh \
	tests/e2e/cluster_error.sh \
	tests/e2e/cluster_passes.sh \
	tests/e2e/cluster_preview.sh \
	tests/e2e/reuse.sh \
	tests/e2e/cluster_peers.sh \
	tests/e2e/cluster_sandbox.sh \
	tests/e2e/cluster_sockets.sh \
	tests/e2e/glow_rays.sh \
	tests/e2e/identity.sh \
	tests/e2e/identity_faults.sh \
	tests/e2e/keys.sh \
	tests/e2e/manpages.sh \
	tests/e2e/materials.sh \
	tests/e2e/oversample_memory.sh \
	tests/e2e/other_libm.sh \
	tests/e2e/owners.sh \
	tests/e2e/fetch_spoilt.sh \
	tests/e2e/kept_jobs.sh \
	tests/e2e/launch.sh \
	tests/e2e/launch_real.sh \
	tests/e2e/radctl_check.sh \
	tests/e2e/state_damage.sh \
	tests/e2e/radctl_here.sh \
	tests/e2e/radctl_lists.sh \
	tests/e2e/radctl_text.sh \
	tests/e2e/radctl_top.sh \
	tests/e2e/radd_hours.sh \
	tests/e2e/radd_refused.sh \
	tests/e2e/radd_shortage.sh \
	tests/e2e/raderr.sh \
	tests/e2e/sim_windows.sh \
	tests/e2e/slurm.sh \
	tests/e2e/stats.sh \
	tests/e2e/steer.sh \
	tests/e2e/steer_first.sh \
	tests/e2e/submit_ambient.sh \
	tests/e2e/submit_bad_input.sh \
	tests/e2e/submit_detach.sh \
	tests/e2e/submit_dry_run.sh \
	tests/e2e/submit_error.sh \
	tests/e2e/submit_interrupt.sh \
	tests/e2e/submit_left.sh \
	tests/e2e/submit_false_colour.sh \
	tests/e2e/submit_header.sh \
	tests/e2e/submit_limits.sh \
	tests/e2e/submit_outputs.sh \
	tests/e2e/submit_bands.sh \
	tests/e2e/submit_oversample.sh \
	tests/e2e/rpict_path.sh \
	tests/e2e/rtrace_path.sh \
	tests/e2e/points_stream.sh \
	tests/e2e/submit_points.sh \
	tests/e2e/submit_parts.sh \
	tests/e2e/submit_rif.sh \
	tests/e2e/submit_tone.sh \
	tests/e2e/submit_walk.sh \
	tests/e2e/systemd_units.sh \
	tests/e2e/radweb.sh \
	tests/e2e/radweb_page.sh \
	tests/e2e/versions.sh \
	tests/e2e/words.sh
EXTRA_DIST += \
	tests/e2e/chance.sh \
	tests/e2e/client_lib.sh \
	tests/e2e/cluster.sh \
	tests/web/ask.py \
	tests/web/browser.py \
	tests/web/click.py \
	tests/e2e/steer_lib.sh \
	tests/e2e/faults.sh \
	tests/scenes
TESTS += \
	tests/e2e/cluster_backpressure.sh \
	tests/e2e/cluster_crash.sh \
	tests/e2e/completion.sh \
	tests/e2e/enroll.sh \
	tests/e2e/daemon_settings.sh \
	tests/e2e/coord_frames.sh \
	tests/e2e/coord_full.sh \
	tests/e2e/cluster_cache.sh \
	tests/e2e/cluster_files.sh \
	tests/e2e/cluster_descriptors.sh \
	tests/e2e/cluster_flood.sh \
	tests/e2e/cluster_keys.sh \
	tests/e2e/cluster_error.sh \
	tests/e2e/cluster_passes.sh \
	tests/e2e/cluster_preview.sh \
	tests/e2e/reuse.sh \
	tests/e2e/cluster_peers.sh \
	tests/e2e/cluster_sandbox.sh \
	tests/e2e/cluster_sockets.sh \
	tests/e2e/glow_rays.sh \
	tests/e2e/identity.sh \
	tests/e2e/identity_faults.sh \
	tests/e2e/keys.sh \
	tests/e2e/manpages.sh \
	tests/e2e/materials.sh \
	tests/e2e/oversample_memory.sh \
	tests/e2e/other_libm.sh \
	tests/e2e/owners.sh \
	tests/e2e/fetch_spoilt.sh \
	tests/e2e/kept_jobs.sh \
	tests/e2e/launch.sh \
	tests/e2e/launch_real.sh \
	tests/e2e/radctl_check.sh \
	tests/e2e/state_damage.sh \
	tests/e2e/radctl_here.sh \
	tests/e2e/radctl_lists.sh \
	tests/e2e/radctl_text.sh \
	tests/e2e/radctl_top.sh \
	tests/e2e/radd_hours.sh \
	tests/e2e/radd_refused.sh \
	tests/e2e/radd_shortage.sh \
	tests/e2e/raderr.sh \
	tests/e2e/sim_windows.sh \
	tests/e2e/slurm.sh \
	tests/e2e/stats.sh \
	tests/e2e/steer.sh \
	tests/e2e/steer_first.sh \
	tests/e2e/submit_ambient.sh \
	tests/e2e/submit_bad_input.sh \
	tests/e2e/submit_detach.sh \
	tests/e2e/submit_dry_run.sh \
	tests/e2e/submit_error.sh \
	tests/e2e/submit_interrupt.sh \
	tests/e2e/submit_left.sh \
	tests/e2e/submit_false_colour.sh \
	tests/e2e/submit_header.sh \
	tests/e2e/submit_limits.sh \
	tests/e2e/submit_outputs.sh \
	tests/e2e/submit_bands.sh \
	tests/e2e/submit_oversample.sh \
	tests/e2e/rpict_path.sh \
	tests/e2e/rtrace_path.sh \
	tests/e2e/points_stream.sh \
	tests/e2e/submit_points.sh \
	tests/e2e/submit_parts.sh \
	tests/e2e/submit_rif.sh \
	tests/e2e/submit_tone.sh \
	tests/e2e/submit_walk.sh \
	tests/e2e/systemd_units.sh \
	tests/e2e/radweb.sh \
	tests/e2e/radweb_page.sh \
	tests/e2e/versions.sh \
	tests/e2e/words.sh

tests_check_ring_SOURCES = tests/check_ring.c tests/unit.h
tests_check_ring_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_ring_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coord_conns_SOURCES = tests/check_coord_conns.c \
	tests/coord_fixture.h tests/unit.h
tests_check_coord_conns_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_coord_conns_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coord_faults_SOURCES = tests/check_coord_faults.c \
	tests/coord_fixture.h tests/unit.h
tests_check_coord_faults_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_coord_faults_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_reuse_SOURCES = tests/check_reuse.c tests/coord_fixture.h tests/unit.h
tests_check_reuse_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_reuse_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coord_passes_SOURCES = tests/check_coord_passes.c \
	tests/coord_fixture.h tests/unit.h
tests_check_coord_passes_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_coord_passes_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coord_jobs_SOURCES = tests/check_coord_jobs.c \
	tests/coord_fixture.h tests/unit.h
tests_check_coord_jobs_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_coord_jobs_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coord_order_SOURCES = tests/check_coord_order.c \
	tests/coord_fixture.h tests/unit.h
tests_check_coord_order_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_coord_order_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_listing_SOURCES = tests/check_listing.c \
	tests/coord_fixture.h tests/unit.h
tests_check_listing_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_listing_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coord_rows_SOURCES = tests/check_coord_rows.c \
	tests/coord_fixture.h tests/unit.h
tests_check_coord_rows_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_coord_rows_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_seeding_SOURCES = tests/check_seeding.c \
	tests/coord_fixture.h tests/unit.h
tests_check_seeding_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_seeding_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_handoff_SOURCES = tests/check_handoff.c \
	tests/lines_fixture.h tests/unit.h
tests_check_handoff_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_handoff_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_back_SOURCES = tests/check_back.c \
	tests/lines_fixture.h tests/unit.h
tests_check_back_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_back_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_coarse_SOURCES = tests/check_coarse.c tests/unit.h
tests_check_coarse_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_coarse_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_shelf_SOURCES = tests/check_shelf.c tests/unit.h
tests_check_shelf_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_shelf_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_states_SOURCES = tests/check_states.c tests/unit.h
tests_check_states_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_states_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_parked_SOURCES = tests/check_parked.c \
	tests/lines_fixture.h tests/unit.h
tests_check_parked_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_parked_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_yield_SOURCES = tests/check_yield.c \
	tests/lines_fixture.h tests/unit.h
tests_check_yield_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_yield_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_balance_SOURCES = tests/check_balance.c \
	tests/lines_fixture.h tests/unit.h
tests_check_balance_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_balance_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_lending_SOURCES = tests/check_lending.c \
	tests/lines_fixture.h tests/unit.h
tests_check_lending_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_lending_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_twins_SOURCES = tests/check_twins.c \
	tests/lines_fixture.h tests/unit.h
tests_check_twins_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_twins_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_survey_SOURCES = tests/check_survey.c \
	tests/lines_fixture.h tests/unit.h
tests_check_survey_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_survey_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_points_SOURCES = tests/check_points.c tests/unit.h
tests_check_points_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_points_LDADD = $(UNIT_LIBS)

tests_check_partition_SOURCES = tests/check_partition.c tests/unit.h
tests_check_partition_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_partition_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_worker_SOURCES = tests/check_worker.c tests/unit.h
tests_check_worker_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_worker_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_seeds_SOURCES = tests/check_seeds.c tests/unit.h
tests_check_seeds_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_seeds_LDADD = $(LIBPROTO) $(LIBRAD) $(UNIT_LIBS)

tests_check_message_SOURCES = tests/check_message.c tests/unit.h
tests_check_message_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_message_LDADD = $(LIBPROTO) $(UNIT_LIBS)
EXTRA_DIST += tests/golden

tests_check_owner_SOURCES = tests/check_owner.c tests/unit.h
tests_check_owner_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_owner_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_gate_SOURCES = tests/check_gate.c tests/unit.h
tests_check_gate_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_gate_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_web_SOURCES = tests/check_web.c tests/unit.h
tests_check_web_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS) \
	$(UV_CFLAGS)
tests_check_web_LDADD = $(radweb_LDADD) $(UNIT_LIBS)

tests_check_watch_SOURCES = tests/check_watch.c tests/unit.h
tests_check_watch_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS) \
	$(UV_CFLAGS)
tests_check_watch_LDADD = $(radweb_LDADD) $(UNIT_LIBS)

tests_check_keyfile_SOURCES = tests/check_keyfile.c tests/unit.h
tests_check_keyfile_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_keyfile_LDADD = $(LIBNET) $(UNIT_LIBS)

tests_check_credentials_SOURCES = tests/check_credentials.c tests/unit.h
tests_check_credentials_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(SSL_CFLAGS)
tests_check_credentials_LDADD = $(LIBNET) $(UNIT_LIBS)

tests_check_tls_SOURCES = tests/check_tls.c tests/unit.h
tests_check_tls_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(SSL_CFLAGS)
tests_check_tls_LDADD = $(LIBNET) $(UNIT_LIBS)

tests_check_tone_SOURCES = tests/check_tone.c tests/unit.h
tests_check_tone_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_tone_LDADD = $(LIBCLIENT) $(UNIT_LIBS)

tests_check_wire_SOURCES = tests/check_wire.c tests/unit.h
tests_check_wire_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_wire_LDADD = $(LIBPROTO) $(UNIT_LIBS)

tests_check_sim_SOURCES = \
	tests/sim/check_sim.c \
	tests/sim/child.c \
	tests/sim/client.c \
	tests/sim/cluster.c \
	tests/sim/cluster.h \
	tests/sim/disk.c \
	tests/sim/fault.c \
	tests/sim/fibre.c \
	tests/sim/fibre.h \
	tests/sim/net.c \
	tests/sim/net.h \
	tests/sim/picture.c \
	tests/sim/tiles.c
tests_check_sim_CFLAGS = $(AM_CFLAGS) $(JANSSON_CFLAGS)
tests_check_sim_LDADD = $(LIBDAEMON) $(LIBRAD)

tests_check_ambshare_SOURCES = tests/check_ambshare.c tests/unit.h
tests_check_ambshare_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_ambshare_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_conf_SOURCES = tests/check_conf.c tests/unit.h
tests_check_conf_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_conf_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_conn_SOURCES = tests/check_conn.c tests/unit.h
tests_check_conn_CPPFLAGS = $(AM_CPPFLAGS)
if !SANITIZED
tests_check_conn_CPPFLAGS += -DWITH_MALLOC
endif
tests_check_conn_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_conn_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_estimate_SOURCES = tests/check_estimate.c tests/unit.h
tests_check_estimate_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_estimate_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_falsecolour_SOURCES = tests/check_falsecolour.c tests/unit.h
tests_check_falsecolour_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_falsecolour_LDADD = $(UNIT_LIBS)

tests_check_fair_SOURCES = tests/check_fair.c tests/unit.h
tests_check_fair_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_fair_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_quota_SOURCES = tests/check_quota.c tests/coord_fixture.h tests/unit.h
tests_check_quota_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(JANSSON_CFLAGS)
tests_check_quota_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_refine_SOURCES = tests/check_refine.c tests/unit.h tests/world.h
tests_check_refine_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_refine_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_passes_SOURCES = tests/check_passes.c tests/unit.h tests/world.h
tests_check_passes_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_passes_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_seed_SOURCES = tests/check_seed.c tests/unit.h tests/world.h
tests_check_seed_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_seed_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_pool_SOURCES = daemon/child/pool_unit.c tests/check_pool.c tests/hook.h \
	tests/unit.h
tests_check_pool_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_TEST_HOOKS
tests_check_pool_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_pool_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_task_SOURCES = tests/check_task.c tests/unit.h
tests_check_task_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS) $(UV_CFLAGS)
tests_check_task_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_team_SOURCES = tests/analytic.h tests/check_team.c \
	tests/team_fixture.h tests/unit.h
tests_check_team_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_team_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_team_lend_SOURCES = tests/analytic.h \
	tests/check_team_lend.c tests/team_fixture.h tests/unit.h
tests_check_team_lend_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_team_lend_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_team_member_SOURCES = tests/analytic.h \
	tests/check_team_member.c tests/team_fixture.h tests/unit.h
tests_check_team_member_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_team_member_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_cache_SOURCES = tests/check_cache.c tests/unit.h
tests_check_cache_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_cache_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_known_SOURCES = tests/check_known.c tests/unit.h
tests_check_known_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_known_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_idle_SOURCES = tests/check_idle.c tests/unit.h
tests_check_idle_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_idle_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_sandbox_SOURCES = tests/check_sandbox.c tests/unit.h
tests_check_sandbox_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_sandbox_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_shell_SOURCES = tests/check_shell.c tests/unit.h
tests_check_shell_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_shell_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_store_SOURCES = tests/check_store.c tests/unit.h
tests_check_store_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_store_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_strict_SOURCES = tests/check_strict.c tests/unit.h
tests_check_strict_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_strict_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_strict_loan_SOURCES = tests/check_strict_loan.c \
	tests/strict_fixture.h tests/unit.h
tests_check_strict_loan_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_strict_loan_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_strict_pass_SOURCES = tests/check_strict_pass.c \
	tests/strict_fixture.h tests/unit.h
tests_check_strict_pass_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_strict_pass_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_strict_rank_SOURCES = tests/check_strict_rank.c \
	tests/strict_fixture.h tests/unit.h
tests_check_strict_rank_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_strict_rank_LDADD = $(LIBDAEMON) $(UNIT_LIBS)
tests_check_strict_unit_SOURCES = tests/check_strict_unit.c \
	tests/strict_fixture.h tests/unit.h
tests_check_strict_unit_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_strict_unit_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_doubt_SOURCES = tests/check_doubt.c tests/unit.h tests/world.h
tests_check_doubt_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_doubt_LDADD = $(LIBDAEMON) $(UNIT_LIBS)

tests_check_metric_SOURCES = tests/check_metric.c tests/unit.h
tests_check_metric_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_metric_LDADD = $(UNIT_LIBS)

tests_check_wgmd_SOURCES = tests/check_wgmd.c tests/square.h tests/suns.h \
	tests/unit.h tests/world.h
tests_check_wgmd_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_wgmd_LDADD = $(UNIT_LIBS)

tests_check_wild_SOURCES = tests/check_wild.c tests/unit.h tests/wild.h \
	tests/world.h
tests_check_wild_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_wild_LDADD = $(UNIT_LIBS)

tests_check_fprism_SOURCES = tests/check_fprism.c tests/unit.h
tests_check_fprism_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_fprism_LDADD = $(UNIT_LIBS)

tests_check_frame_SOURCES = tests/check_frame.c tests/unit.h
tests_check_frame_CFLAGS = $(AM_CFLAGS) $(CHECK_CFLAGS)
tests_check_frame_LDADD = $(UNIT_LIBS)

# Tests whose code runs in threads: once more under ThreadSanitizer.
THREAD_TESTS = \
	tests/check_ambcache \
	tests/check_ambient \
	tests/check_bright \
	tests/check_estimate \
	tests/check_facts \
	tests/check_fair \
	tests/check_pool \
	tests/check_smooth \
	tests/check_task \
	tests/check_team \
	tests/check_team_lend \
	tests/check_team_member
# Shell tests that also run with sanitized programs.
SANITIZED_E2E = \
	tests/e2e/cluster_garbage.sh \
	tests/e2e/cluster_kill.sh \
	tests/e2e/cluster_restart.sh \
	tests/e2e/radscene.sh \
	tests/e2e/submit_embedded.sh

E2E_TESTS = $(SANITIZED_E2E)
TESTS += $(E2E_TESTS)
dist_check_SCRIPTS += $(E2E_TESTS)

SANITIZED_MORE = \
	tests/fuzz/replay.sh \
	tests/soak/pairs.sh

.PHONY: check-sanitized check-threads
check-sanitized:
	$(MAKE) $(AM_MAKEFLAGS) check \
		TESTS='$(UNIT_TESTS) $(SANITIZED_MORE) $(SANITIZED_E2E)'
check-threads:
	$(MAKE) $(AM_MAKEFLAGS) check TESTS='$(THREAD_TESTS) $(SANITIZED_E2E)'

# The floor plan of doc/architecture.md against the code.
TESTS += tests/doors.sh
dist_check_SCRIPTS += tests/doors.sh

# The Debian packages in clean trees of Debian; for root.
EXTRA_DIST += tests/packages/booted.sh tests/packages/packages.sh \
	tests/packages/room.rad
.PHONY: check-packages
check-packages: dist
	$(srcdir)/tests/packages/packages.sh $(distdir).tar.xz
