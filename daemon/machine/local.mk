# what the pure machines share, and clients with them: states, actions, texts of
# a job, sums, lists as JSON
libdaemon_a_SOURCES += \
	daemon/machine/action.c \
	daemon/machine/action.h \
	daemon/machine/counted.c \
	daemon/machine/counted.h \
	daemon/machine/fingerprint.c \
	daemon/machine/fingerprint.h \
	daemon/machine/jobtext.c \
	daemon/machine/jobtext.h \
	daemon/machine/lists.c \
	daemon/machine/lists.h \
	daemon/machine/rowsum.c \
	daemon/machine/rowsum.h \
	daemon/machine/steps.c \
	daemon/machine/steps.h \
	daemon/machine/spots.c \
	daemon/machine/spots.h \
	daemon/machine/sums.c \
	daemon/machine/sums.h \
	daemon/machine/saved.h \
	daemon/machine/shelf.c \
	daemon/machine/shelf.h
