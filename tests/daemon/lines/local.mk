# tests of units, and of lines that workers share
UNIT_TESTS += \
	tests/daemon/lines/check_back \
	tests/daemon/lines/check_balance \
	tests/daemon/lines/check_handoff \
	tests/daemon/lines/check_lending \
	tests/daemon/lines/check_parked \
	tests/daemon/lines/check_partition \
	tests/daemon/lines/check_partition_lines \
	tests/daemon/lines/check_survey \
	tests/daemon/lines/check_twins \
	tests/daemon/lines/check_yield

noinst_HEADERS += \
	tests/daemon/lines/lines_fixture.h
