# pictures as they are shown and kept
libclient_a_SOURCES += \
	client/show/expose.c \
	client/show/expose.h \
	client/show/origin.c \
	client/show/origin.h \
	client/show/picfile.c \
	client/show/picfile.h \
	client/show/show.c \
	client/show/show.h \
	client/show/spectra.c \
	client/show/spectra.h
