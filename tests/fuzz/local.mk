# Fuzz targets, fuzz_<decoder>.c with seeds in corpus/<decoder>/.  An ordinary
# build links each with replay.c and `make check` replays the corpora; with
# --enable-fuzzers they are libFuzzer programs: tests/fuzz/fuzz_x corpus/x
#
# To add one: its name to FUZZ_TARGETS, and the two lines of its own below.
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
FUZZ_MAIN =
FUZZ_LINK = $(AM_LDFLAGS) -fsanitize=fuzzer
else
FUZZ_MAIN = tests/fuzz/replay.c
FUZZ_LINK = $(AM_LDFLAGS)
endif

check_PROGRAMS += $(FUZZ_TARGETS)
dist_check_SCRIPTS += tests/fuzz/coverage.sh tests/fuzz/replay.sh \
	tests/fuzz/run.sh
EXTRA_DIST += tests/fuzz/corpus tests/fuzz/reach tests/fuzz/replay.c
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

tests_fuzz_fuzz_ambfile_SOURCES = tests/fuzz/fuzz_ambfile.c $(FUZZ_MAIN)
tests_fuzz_fuzz_ambfile_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_ambshare_SOURCES = tests/fuzz/fuzz_ambshare.c $(FUZZ_MAIN)
tests_fuzz_fuzz_ambshare_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_bsdf_SOURCES = tests/fuzz/fuzz_bsdf.c $(FUZZ_MAIN)
tests_fuzz_fuzz_bsdf_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_bundle_SOURCES = tests/fuzz/fuzz_bundle.c $(FUZZ_MAIN)
tests_fuzz_fuzz_bundle_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_cache_SOURCES = tests/fuzz/fuzz_cache.c $(FUZZ_MAIN)
tests_fuzz_fuzz_cache_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_calc_SOURCES = tests/fuzz/fuzz_calc.c $(FUZZ_MAIN)
tests_fuzz_fuzz_calc_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_conf_SOURCES = tests/fuzz/fuzz_conf.c $(FUZZ_MAIN)
tests_fuzz_fuzz_conf_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_costs_SOURCES = tests/fuzz/fuzz_costs.c $(FUZZ_MAIN)
tests_fuzz_fuzz_costs_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_dat_SOURCES = tests/fuzz/fuzz_dat.c $(FUZZ_MAIN)
tests_fuzz_fuzz_dat_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_facts_SOURCES = tests/fuzz/fuzz_facts.c $(FUZZ_MAIN)
tests_fuzz_fuzz_facts_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_font_SOURCES = tests/fuzz/fuzz_font.c $(FUZZ_MAIN)
tests_fuzz_fuzz_font_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_frame_SOURCES = tests/fuzz/fuzz_frame.c $(FUZZ_MAIN)
tests_fuzz_fuzz_frame_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_hdr_SOURCES = tests/fuzz/fuzz_hdr.c $(FUZZ_MAIN)
tests_fuzz_fuzz_hdr_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_hsr_SOURCES = tests/fuzz/fuzz_hsr.c $(FUZZ_MAIN)
tests_fuzz_fuzz_hsr_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_journal_SOURCES = tests/fuzz/fuzz_journal.c $(FUZZ_MAIN)
tests_fuzz_fuzz_journal_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_keyfile_SOURCES = tests/fuzz/fuzz_keyfile.c $(FUZZ_MAIN)
tests_fuzz_fuzz_keyfile_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_octfile_SOURCES = tests/fuzz/fuzz_octfile.c $(FUZZ_MAIN)
tests_fuzz_fuzz_octfile_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_params_SOURCES = tests/fuzz/fuzz_params.c $(FUZZ_MAIN)
tests_fuzz_fuzz_params_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_parse_SOURCES = tests/fuzz/fuzz_parse.c $(FUZZ_MAIN)
tests_fuzz_fuzz_parse_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_planes_SOURCES = tests/fuzz/fuzz_planes.c $(FUZZ_MAIN)
tests_fuzz_fuzz_planes_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_points_SOURCES = tests/fuzz/fuzz_points.c $(FUZZ_MAIN)
tests_fuzz_fuzz_points_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_rif_SOURCES = tests/fuzz/fuzz_rif.c $(FUZZ_MAIN)
tests_fuzz_fuzz_rif_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_rtm_SOURCES = tests/fuzz/fuzz_rtm.c $(FUZZ_MAIN)
tests_fuzz_fuzz_rtm_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_session_SOURCES = tests/fuzz/fuzz_session.c $(FUZZ_MAIN)
tests_fuzz_fuzz_session_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_tls_SOURCES = tests/fuzz/fuzz_tls.c $(FUZZ_MAIN)
tests_fuzz_fuzz_tls_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_units_SOURCES = tests/fuzz/fuzz_units.c $(FUZZ_MAIN)
tests_fuzz_fuzz_units_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_units_CFLAGS = $(AM_CFLAGS) $(JANSSON_CFLAGS)
tests_fuzz_fuzz_units_LDADD = libweb.a $(LIBRAD) $(JANSSON_LIBS)
tests_fuzz_fuzz_view_SOURCES = tests/fuzz/fuzz_view.c $(FUZZ_MAIN)
tests_fuzz_fuzz_view_LDFLAGS = $(FUZZ_LINK)
tests_fuzz_fuzz_worker_SOURCES = tests/fuzz/fuzz_worker.c $(FUZZ_MAIN)
tests_fuzz_fuzz_worker_LDFLAGS = $(FUZZ_LINK)
