# talking with a coordinator, another's or one of its own
libclient_a_SOURCES += \
	client/link/fetch.c \
	client/link/fetch.h \
	client/link/launch.c \
	client/link/launch.h \
	client/link/link.c \
	client/link/link.h \
	client/link/local.c \
	client/link/local.h \
	client/link/order.c \
	client/link/order.h \
	client/link/programs.c \
	client/link/programs.h \
	client/link/rescue.c \
	client/link/rescue.h \
	client/link/roll.c \
	client/link/roll.h \
	client/link/submit.c \
	client/link/submit.h \
	client/link/submit_ask.c \
	client/link/submit_ends.c \
	client/link/submit_impl.h \
	client/link/submit_results.c \
	client/link/submit_talk.c \
	client/link/target.c \
	client/link/target.h
