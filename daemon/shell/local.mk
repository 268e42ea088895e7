# what the shells of both daemons share: connections to events, actions carried out, files sent
libdaemon_a_SOURCES += \
	daemon/shell/shell.c \
	daemon/shell/shell.h \
	daemon/shell/transfer.c \
	daemon/shell/transfer.h
