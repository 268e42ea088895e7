# sensor points: rtrace's options, its input and its output
libclient_a_SOURCES += \
	client/points/pointfacts.c \
	client/points/pointfacts.h \
	client/points/pointfile.c \
	client/points/pointfile.h \
	client/points/pointjob.c \
	client/points/pointjob.h \
	client/points/pointspec.c \
	client/points/pointspec.h \
	client/points/pointstream.c \
	client/points/pointstream.h \
	client/points/pointwriter.c \
	client/points/pointwriter.h
