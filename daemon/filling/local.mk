# the ambient cache of a job, before its units
libdaemon_a_SOURCES += \
	daemon/filling/colours.c \
	daemon/filling/colours.h \
	daemon/filling/filled.c \
	daemon/filling/filled.h \
	daemon/filling/passes.c \
	daemon/filling/passes.h \
	daemon/filling/passes_impl.h \
	daemon/filling/records.c \
	daemon/filling/records.h \
	daemon/filling/stages.c \
	daemon/filling/stages.h \
	daemon/filling/tiles.c \
	daemon/filling/tiles.h
