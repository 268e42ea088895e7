# the worker daemon: the shell around the worker
radd_SOURCES = \
	daemon/radd/radd.c \
	daemon/radd/radd_conf.c \
	daemon/radd/radd_conf.h
libdaemon_a_SOURCES += \
	daemon/radd/children.c \
	daemon/radd/children.h \
	daemon/radd/hours.c \
	daemon/radd/hours.h \
	daemon/radd/idle.c \
	daemon/radd/idle.h \
	daemon/radd/launched.c \
	daemon/radd/launched.h
