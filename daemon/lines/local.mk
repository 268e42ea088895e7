# what the coordinator does with lines under way: hand-off, lending
libdaemon_a_SOURCES += \
	daemon/lines/handoff.c \
	daemon/lines/handoff.h \
	daemon/lines/lending.c \
	daemon/lines/lending.h
