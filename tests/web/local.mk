# tests of radweb, and programs that ask it and look at it for shell tests
UNIT_TESTS += \
	tests/web/check_confine \
	tests/web/check_watch \
	tests/web/check_web

tests_web_check_confine_LDADD = $(radweb_LDADD) $(LDADD)
tests_web_check_watch_LDADD = $(radweb_LDADD) $(LDADD)
tests_web_check_web_LDADD = $(radweb_LDADD) $(LDADD)

EXTRA_DIST += \
	tests/web/ask.py \
	tests/web/browser.py \
	tests/web/click.py
