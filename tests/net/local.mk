# tests of net
UNIT_TESTS += \
	tests/net/check_conn \
	tests/net/check_credentials \
	tests/net/check_fair \
	tests/net/check_gate \
	tests/net/check_keyfile \
	tests/net/check_tls

tests_net_check_conn_CPPFLAGS = $(AM_CPPFLAGS)
if !SANITIZED
tests_net_check_conn_CPPFLAGS += -DWITH_MALLOC
endif
