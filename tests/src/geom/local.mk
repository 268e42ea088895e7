# tests of src/geom and src/trace
UNIT_TESTS += \
	tests/src/geom/check_bvh \
	tests/src/geom/check_geom \
	tests/src/geom/check_line \
	tests/src/geom/check_place \
	tests/src/geom/check_ray

noinst_HEADERS += \
	tests/src/geom/geom_scene.h
