# the threads that render in a job's child
libdaemon_a_SOURCES += \
	daemon/pool/estimate.c \
	daemon/pool/estimate.h \
	daemon/pool/pool.c \
	daemon/pool/pool.h \
	daemon/pool/pool_clock.c \
	daemon/pool/pool_estimate.c \
	daemon/pool/pool_impl.h \
	daemon/pool/pool_strict.c \
	daemon/pool/pool_thread.c \
	daemon/pool/pool_tiles.c \
	daemon/pool/pool_tiles.h \
	daemon/pool/pool_unit.c \
	daemon/pool/wake.c \
	daemon/pool/wake.h
