# tests of proto, and the seeds of fuzz targets that hold messages
UNIT_TESTS += \
	tests/proto/check_framing \
	tests/proto/check_message \
	tests/proto/check_seeds \
	tests/proto/check_spec \
	tests/proto/check_wire

noinst_HEADERS += \
	tests/proto/message_fixture.h
