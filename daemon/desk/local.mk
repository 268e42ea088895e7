# jobs, their units and what becomes of these: rows that come, workers that go
libdaemon_a_SOURCES += \
	daemon/desk/duplicate.c \
	daemon/desk/go.c \
	daemon/desk/go.h \
	daemon/desk/hold.c \
	daemon/desk/job.c \
	daemon/desk/job.h \
	daemon/desk/loss.c \
	daemon/desk/part.c \
	daemon/desk/part.h \
	daemon/desk/result.c \
	daemon/desk/speed.c \
	daemon/desk/unit.c \
	daemon/desk/unit.h
