# tests of daemon/store, folder and journal
UNIT_TESTS += \
	tests/daemon/store/check_coarse \
	tests/daemon/store/check_journal \
	tests/daemon/store/check_rows \
	tests/daemon/store/check_store \
	tests/daemon/store/check_store_lives \
	tests/daemon/store/check_store_rows

noinst_HEADERS += \
	tests/daemon/store/lives_fixture.h \
	tests/daemon/store/rows_fixture.h \
	tests/daemon/store/store_fixture.h
