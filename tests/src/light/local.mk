# tests of src/light
UNIT_TESTS += \
	tests/src/light/check_ambcache \
	tests/src/light/check_ambient \
	tests/src/light/check_ambserving \
	tests/src/light/check_bright \
	tests/src/light/check_gradient \
	tests/src/light/check_mirror \
	tests/src/light/check_prism \
	tests/src/light/check_sample \
	tests/src/light/check_smooth \
	tests/src/light/check_source

tests_src_light_check_ambcache_LDFLAGS = $(AM_LDFLAGS) -Wl,--wrap=malloc \
	-Wl,--wrap=calloc -Wl,--wrap=realloc -Wl,--wrap=aligned_alloc
