# tests of src/shade and src/pattern
UNIT_TESTS += \
	tests/src/shade/check_aniso \
	tests/src/shade/check_antimatter \
	tests/src/shade/check_ashik \
	tests/src/shade/check_brdf \
	tests/src/shade/check_bsdf \
	tests/src/shade/check_func \
	tests/src/shade/check_mist \
	tests/src/shade/check_shade \
	tests/src/shade/check_table \
	tests/src/shade/check_wgmd

noinst_HEADERS += \
	tests/src/shade/square.h \
	tests/src/shade/suns.h
