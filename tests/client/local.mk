# tests of client
UNIT_TESTS += \
	tests/client/check_ambfile \
	tests/client/check_client \
	tests/client/check_compile \
	tests/client/check_costs \
	tests/client/check_link \
	tests/client/check_options \
	tests/client/check_origin \
	tests/client/check_outcome \
	tests/client/check_pointfile \
	tests/client/check_pointstream \
	tests/client/check_rays \
	tests/client/check_rif \
	tests/client/check_show \
	tests/client/check_submit \
	tests/client/check_surroundings \
	tests/client/check_top \
	tests/client/check_trial
