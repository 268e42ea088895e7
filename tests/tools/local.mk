# Programs that the tests run; check-threads makes these and its own tests.
TOOLS = \
	tests/tools/confine \
	tests/tools/flood \
	tests/tools/poke \
	tests/tools/proxy \
	tests/tools/radd-hooked \
	tests/tools/seqpict \
	tests/tools/shown
check_PROGRAMS += $(TOOLS)

# The renderer alone, the reference for the cluster.
tests_tools_seqpict_SOURCES = tests/tools/seqpict.c
tests_tools_seqpict_LDADD = $(LIBCLIENT) $(LIBRAD)

# What a tone curve makes of a picture, and what a PNG holds.
tests_tools_shown_SOURCES = tests/tools/shown.c
tests_tools_shown_CFLAGS = $(AM_CFLAGS) $(PNG_CFLAGS)
tests_tools_shown_LDADD = $(LIBCLIENT) $(LIBRAD)

# sends bytes to a socket, for the shell tests
tests_tools_flood_SOURCES = tests/tools/flood.c
tests_tools_flood_LDADD = $(LIBDAEMON) $(LIBRAD)

tests_tools_poke_SOURCES = tests/tools/poke.c
tests_tools_poke_LDADD = $(LIBDAEMON) $(LIBRAD)

# what may befall the coordinator, for LD_PRELOAD: no program is linked with it
check_DATA += tests/tools/disaster.so
EXTRA_DIST += tests/tools/disaster.c
CLEANFILES += tests/tools/disaster.so
tests/tools/disaster.so: $(top_srcdir)/tests/tools/disaster.c config.h
	$(AM_V_CC)$(MKDIR_P) $(@D) && \
	$(CC) -std=gnu11 -O1 -g -Wall -Wextra $(DEFS) $(DEFAULT_INCLUDES) \
		-shared -fPIC -o $@ $(top_srcdir)/tests/tools/disaster.c

# radd with the hooks of tests/tools/hook.h: not to be installed
tests_tools_radd_hooked_SOURCES = $(radd_SOURCES) daemon/pool/pool_unit.c \
	tests/tools/hook.c tests/tools/hook.h
tests_tools_radd_hooked_CPPFLAGS = $(radd_CPPFLAGS) -DRADD_TEST_HOOKS
tests_tools_radd_hooked_CFLAGS = $(radd_CFLAGS)
tests_tools_radd_hooked_LDADD = $(radd_LDADD)

# a bad connection, for the shell tests
tests_tools_proxy_SOURCES = tests/tools/proxy.c
tests_tools_proxy_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
tests_tools_proxy_LDADD = $(LIBDAEMON) $(LIBRAD)

# runs a program as a unit of systemd would
tests_tools_confine_SOURCES = tests/tools/confine.c
tests_tools_confine_CFLAGS = $(AM_CFLAGS) $(SECCOMP_CFLAGS)
tests_tools_confine_LDADD = $(SECCOMP_LIBS)
