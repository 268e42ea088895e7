# jobs, their units and what becomes of these: rows that come, workers that go
libdaemon_a_SOURCES += \
	daemon/desk/account.h \
	daemon/desk/desk.c \
	daemon/desk/desk.h \
	daemon/desk/duplicate.c \
	daemon/desk/duplicate.h \
	daemon/desk/env.h \
	daemon/desk/frame.c \
	daemon/desk/frame.h \
	daemon/desk/goal.c \
	daemon/desk/goal.h \
	daemon/desk/go.c \
	daemon/desk/go.h \
	daemon/desk/hold.c \
	daemon/desk/hold.h \
	daemon/desk/job.c \
	daemon/desk/job.h \
	daemon/desk/kept.c \
	daemon/desk/kept.h \
	daemon/desk/part.c \
	daemon/desk/part.h \
	daemon/desk/progress.c \
	daemon/desk/progress.h \
	daemon/desk/shared.c \
	daemon/desk/shared.h \
	daemon/desk/speed.c \
	daemon/desk/speed.h \
	daemon/desk/unit.c \
	daemon/desk/unit.h \
	daemon/desk/verdict.c \
	daemon/desk/verdict.h
