# tests of daemon/ground, files and shell, and of shelf of daemon/machine
UNIT_TESTS += \
	tests/daemon/ground/check_cache \
	tests/daemon/ground/check_conf \
	tests/daemon/ground/check_files \
	tests/daemon/ground/check_shelf \
	tests/daemon/ground/check_shell \
	tests/daemon/ground/check_task \
	tests/daemon/ground/check_transfer
