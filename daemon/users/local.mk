# who users are, and what they may have
libdaemon_a_SOURCES += \
	daemon/users/known.c \
	daemon/users/known.h \
	daemon/users/owner.c \
	daemon/users/owner.h \
	daemon/users/uploads.c \
	daemon/users/uploads.h
