# tests of daemon/worker, and of the hours in which a worker may work
UNIT_TESTS += \
	tests/daemon/worker/check_ambshare \
	tests/daemon/worker/check_idle \
	tests/daemon/worker/check_worker \
	tests/daemon/worker/check_worker_lines \
	tests/daemon/worker/check_worker_peers

noinst_HEADERS += \
	tests/daemon/worker/worker_fixture.h
