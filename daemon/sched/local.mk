# which worker gets which unit next
libdaemon_a_SOURCES += \
	daemon/sched/balance.c \
	daemon/sched/balance.h \
	daemon/sched/colours.c \
	daemon/sched/colours.h \
	daemon/sched/dearest.c \
	daemon/sched/dearest.h \
	daemon/sched/stages.c \
	daemon/sched/stages.h \
	daemon/sched/handout.c \
	daemon/sched/handout.h \
	daemon/sched/lead.c \
	daemon/sched/lead.h \
	daemon/sched/loss.c \
	daemon/sched/loss.h \
	daemon/sched/passes.c \
	daemon/sched/passes.h \
	daemon/sched/result.c \
	daemon/sched/result.h \
	daemon/sched/sched.c \
	daemon/sched/sched.h \
	daemon/sched/sched_tick.c \
	daemon/sched/survey.c \
	daemon/sched/survey.h \
	daemon/sched/yield.c \
	daemon/sched/yield.h
