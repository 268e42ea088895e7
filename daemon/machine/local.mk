# what the pure machines share: actions, and the shell that carries them out
libdaemon_a_SOURCES += \
	daemon/machine/action.c \
	daemon/machine/action.h \
	daemon/machine/counted.c \
	daemon/machine/counted.h \
	daemon/machine/jobtext.c \
	daemon/machine/jobtext.h \
	daemon/machine/rowsum.c \
	daemon/machine/rowsum.h \
	daemon/machine/saved.h \
	daemon/machine/shell.c \
	daemon/machine/shell.h \
	daemon/machine/transfer.c \
	daemon/machine/transfer.h \
	daemon/machine/views.c \
	daemon/machine/views.h \
	daemon/machine/wordlist.c \
	daemon/machine/wordlist.h
