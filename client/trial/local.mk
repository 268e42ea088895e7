# what a job will take, from a short trial, and how far it is
libclient_a_SOURCES += \
	client/trial/dryrun.c \
	client/trial/dryrun.h \
	client/trial/outcome.c \
	client/trial/outcome.h \
	client/trial/progress.c \
	client/trial/progress.h \
	client/trial/surroundings.c \
	client/trial/surroundings.h \
	client/trial/trial.c \
	client/trial/trial.h \
	client/trial/trial_predict.c
