# tests of daemon/child, strict and team
UNIT_TESTS += \
	tests/daemon/child/check_estimate \
	tests/daemon/child/check_pool \
	tests/daemon/child/check_pool_tiles \
	tests/daemon/child/check_render \
	tests/daemon/child/check_sandbox \
	tests/daemon/child/check_strict_loan \
	tests/daemon/child/check_strict_pass \
	tests/daemon/child/check_strict_rank \
	tests/daemon/child/check_strict_unit \
	tests/daemon/child/check_team \
	tests/daemon/child/check_team_lend \
	tests/daemon/child/check_team_member

noinst_HEADERS += \
	tests/daemon/child/analytic.h \
	tests/daemon/child/pool_fixture.h \
	tests/daemon/child/strict_fixture.h \
	tests/daemon/child/team_fixture.h

tests_daemon_child_check_pool_SOURCES = \
	daemon/pool/pool_unit.c \
	tests/daemon/child/check_pool.c
tests_daemon_child_check_pool_CPPFLAGS = $(AM_CPPFLAGS) -DRADD_TEST_HOOKS
