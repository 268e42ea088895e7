# the process that renders a job: its loop
libdaemon_a_SOURCES += \
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
	daemon/child/sandbox.h
