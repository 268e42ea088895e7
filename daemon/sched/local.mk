# which worker gets which unit next
libdaemon_a_SOURCES += \
	daemon/sched/balance.c \
	daemon/sched/balance.h \
	daemon/sched/handout.c \
	daemon/sched/handout.h \
	daemon/sched/loss.c \
	daemon/sched/loss.h \
	daemon/sched/ready.c \
	daemon/sched/ready.h \
	daemon/sched/result.c \
	daemon/sched/result.h \
	daemon/sched/sched.c \
	daemon/sched/sched.h \
	daemon/sched/sched_tick.c \
	daemon/sched/survey.c \
	daemon/sched/survey.h \
	daemon/sched/tally.c \
	daemon/sched/tally.h \
	daemon/sched/turn.c \
	daemon/sched/turn.h \
	daemon/sched/yield.c \
	daemon/sched/yield.h
