# tests of src/image and src/tone
UNIT_TESTS += \
	tests/src/image/check_edge \
	tests/src/image/check_falsecolour \
	tests/src/image/check_filter \
	tests/src/image/check_hdr \
	tests/src/image/check_metric \
	tests/src/image/check_screen \
	tests/src/image/check_spectrum \
	tests/src/image/check_tone
