# a user's files to an octree and a bundle
libclient_a_SOURCES += \
	client/compile/cargo.c \
	client/compile/cargo.h \
	client/compile/command.c \
	client/compile/command.h \
	client/compile/compile.c \
	client/compile/compile.h \
	client/compile/paths.c \
	client/compile/paths.h \
	client/compile/reading.c \
	client/compile/reading.h \
	client/compile/warning.c \
	client/compile/warning.h
