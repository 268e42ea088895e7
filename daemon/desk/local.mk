# what the coordinator knows of all jobs, workers and connections
libdaemon_a_SOURCES += \
	daemon/desk/account.h \
	daemon/desk/desk.c \
	daemon/desk/desk.h \
	daemon/desk/duplicate.c \
	daemon/desk/duplicate.h \
	daemon/desk/env.h \
	daemon/desk/feeding.c \
	daemon/desk/feeding.h \
	daemon/desk/holding.c \
	daemon/desk/holding.h \
	daemon/desk/linking.c \
	daemon/desk/linking.h \
	daemon/desk/order.c \
	daemon/desk/order.h \
	daemon/desk/speed.c \
	daemon/desk/speed.h \
	daemon/desk/verdict.c \
	daemon/desk/verdict.h \
	daemon/desk/worker.h
