# owners of jobs, and the files that users send or may know of
libdaemon_a_SOURCES += \
	daemon/users/known.c \
	daemon/users/known.h \
	daemon/users/owner.c \
	daemon/users/owner.h \
	daemon/users/uploads.c \
	daemon/users/uploads.h
