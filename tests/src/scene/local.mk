# tests of src/scene, and scenes that no one writes
UNIT_TESTS += \
	tests/src/scene/check_bundle \
	tests/src/scene/check_calc \
	tests/src/scene/check_data \
	tests/src/scene/check_font \
	tests/src/scene/check_fprism \
	tests/src/scene/check_hostile \
	tests/src/scene/check_octfile \
	tests/src/scene/check_octree \
	tests/src/scene/check_parse \
	tests/src/scene/check_wild

noinst_HEADERS += \
	tests/src/scene/wild.h
