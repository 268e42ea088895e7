# which worker gets which unit next
libdaemon_a_SOURCES += \
	daemon/sched/balance.c \
	daemon/sched/sched.c \
	daemon/sched/sched.h \
	daemon/sched/survey.c \
	daemon/sched/survey.h \
	daemon/sched/yield.c
