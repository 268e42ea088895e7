# the process that renders a job: its loop and its threads
libdaemon_a_SOURCES += \
	daemon/child/estimate.c \
	daemon/child/estimate.h \
	daemon/child/pool.c \
	daemon/child/pool.h \
	daemon/child/pool_clock.c \
	daemon/child/pool_estimate.c \
	daemon/child/pool_impl.h \
	daemon/child/pool_strict.c \
	daemon/child/pool_thread.c \
	daemon/child/pool_tiles.c \
	daemon/child/pool_tiles.h \
	daemon/child/pool_unit.c \
	daemon/child/render.c \
	daemon/child/render.h \
	daemon/child/render_impl.h \
	daemon/child/render_load.c \
	daemon/child/render_passes.c \
	daemon/child/render_stages.c \
	daemon/child/render_records.c \
	daemon/child/render_tell.c \
	daemon/child/render_units.c \
	daemon/child/sandbox.c \
	daemon/child/sandbox.h \
	daemon/child/wake.c \
	daemon/child/wake.h
