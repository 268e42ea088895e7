# what a job will cost, from a short trial
libclient_a_SOURCES += \
	client/trial/costs.c \
	client/trial/costs.h \
	client/trial/dryrun.c \
	client/trial/dryrun.h \
	client/trial/eta.c \
	client/trial/eta.h \
	client/trial/foresee.c \
	client/trial/foresee.h \
	client/trial/trial.c \
	client/trial/trial.h
