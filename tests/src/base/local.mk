# tests of src/arith and src/base
UNIT_TESTS += \
	tests/src/base/check_base \
	tests/src/base/check_params \
	tests/src/base/check_text
