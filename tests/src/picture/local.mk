# tests of src/picture and src/points
UNIT_TESTS += \
	tests/src/picture/check_doubt \
	tests/src/picture/check_facts \
	tests/src/picture/check_frame \
	tests/src/picture/check_points \
	tests/src/picture/check_quincunx \
	tests/src/picture/check_view
