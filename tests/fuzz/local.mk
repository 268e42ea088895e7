# Fuzz targets, fuzz_<decoder>.c with seeds in corpus/<decoder>/.  An ordinary
# build links each with replay.c and `make check` replays the corpora; with
# --enable-fuzzers they are libFuzzer programs: tests/fuzz/fuzz_x corpus/x
#
# To add one: its name to FUZZ_TARGETS, and its line below.
FUZZ_TARGETS = \
	tests/fuzz/fuzz_ambfile \
	tests/fuzz/fuzz_ambshare \
	tests/fuzz/fuzz_bsdf \
	tests/fuzz/fuzz_bundle \
	tests/fuzz/fuzz_calc \
	tests/fuzz/fuzz_cache \
	tests/fuzz/fuzz_conf \
	tests/fuzz/fuzz_costs \
	tests/fuzz/fuzz_dat \
	tests/fuzz/fuzz_facts \
	tests/fuzz/fuzz_font \
	tests/fuzz/fuzz_frame \
	tests/fuzz/fuzz_hdr \
	tests/fuzz/fuzz_hsr \
	tests/fuzz/fuzz_journal \
	tests/fuzz/fuzz_keyfile \
	tests/fuzz/fuzz_octfile \
	tests/fuzz/fuzz_params \
	tests/fuzz/fuzz_parse \
	tests/fuzz/fuzz_planes \
	tests/fuzz/fuzz_points \
	tests/fuzz/fuzz_rif \
	tests/fuzz/fuzz_rtm \
	tests/fuzz/fuzz_session \
	tests/fuzz/fuzz_tls \
	tests/fuzz/fuzz_units \
	tests/fuzz/fuzz_view \
	tests/fuzz/fuzz_worker

if FUZZERS
FUZZ_LDADD = @LIBFUZZER@ $(LDADD)
else
check_LIBRARIES += libreplay.a
libreplay_a_SOURCES = tests/fuzz/replay.c
FUZZ_LDADD = libreplay.a $(LDADD)
endif

check_PROGRAMS += $(FUZZ_TARGETS)
dist_check_SCRIPTS += tests/fuzz/coverage.sh tests/fuzz/replay.sh \
	tests/fuzz/run.sh
EXTRA_DIST += tests/fuzz/corpus tests/fuzz/reach
TESTS += tests/fuzz/replay.sh

# make fuzz [FUZZ_SECONDS=60] [FUZZ='parse hdr']
FUZZ_SECONDS = 60
FUZZ =
.PHONY: fuzz
fuzz: $(FUZZ_TARGETS)
	top_srcdir='$(top_srcdir)' top_builddir='$(top_builddir)' \
		$(SHELL) $(top_srcdir)/tests/fuzz/run.sh $(FUZZ_SECONDS) $(FUZZ)

# make coverage, in a build with CFLAGS='-O0 -g --coverage'
.PHONY: coverage
coverage: all-am $(check_PROGRAMS)
	top_srcdir='$(top_srcdir)' top_builddir='$(top_builddir)' \
		$(SHELL) $(top_srcdir)/tests/fuzz/coverage.sh

noinst_HEADERS += tests/fuzz/fuzz.h tests/fuzz/steps.h

tests_fuzz_fuzz_ambfile_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_ambshare_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_bsdf_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_bundle_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_cache_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_calc_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_conf_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_costs_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_dat_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_facts_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_font_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_frame_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_hdr_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_hsr_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_journal_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_keyfile_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_octfile_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_params_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_parse_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_planes_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_points_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_rif_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_rtm_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_session_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_tls_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_units_LDADD = libweb.a $(FUZZ_LDADD)
tests_fuzz_fuzz_view_LDADD = $(FUZZ_LDADD)
tests_fuzz_fuzz_worker_LDADD = $(FUZZ_LDADD)
