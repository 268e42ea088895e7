# is a state folder what it should be? for radctl check
libdaemon_a_SOURCES += \
	daemon/check/statecheck.c \
	daemon/check/statecheck.h
