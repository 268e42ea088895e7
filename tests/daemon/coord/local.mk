# tests of the coordinator's decisions: jobs, their owners, workers
UNIT_TESTS += \
	tests/daemon/coord/check_bygone \
	tests/daemon/coord/check_coord_conns \
	tests/daemon/coord/check_coord_faults \
	tests/daemon/coord/check_coord_feeding \
	tests/daemon/coord/check_coord_jobs \
	tests/daemon/coord/check_coord_order \
	tests/daemon/coord/check_coord_passes \
	tests/daemon/coord/check_coord_rows \
	tests/daemon/coord/check_coord_stages \
	tests/daemon/coord/check_delivery \
	tests/daemon/coord/check_known \
	tests/daemon/coord/check_linking \
	tests/daemon/coord/check_listing \
	tests/daemon/coord/check_owner \
	tests/daemon/coord/check_quota \
	tests/daemon/coord/check_reuse \
	tests/daemon/coord/check_states \
	tests/daemon/coord/check_uploads

noinst_HEADERS += \
	tests/daemon/coord/coord_fixture.h \
	tests/daemon/coord/coord_passes_fixture.h
