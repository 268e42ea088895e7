# which workers are linked with which
libdaemon_a_SOURCES += \
	daemon/links/feeding.c \
	daemon/links/feeding.h \
	daemon/links/linking.c \
	daemon/links/linking.h
