# tests of src/passes and src/refine
UNIT_TESTS += \
	tests/src/passes/check_parts \
	tests/src/passes/check_passcost \
	tests/src/passes/check_passes \
	tests/src/passes/check_passplan \
	tests/src/passes/check_recheck \
	tests/src/passes/check_refine
