# files of scenes by their hash: in a folder, sound, kept as long as there is room
libdaemon_a_SOURCES += \
	daemon/files/blobs.c \
	daemon/files/blobs.h \
	daemon/files/cache.c \
	daemon/files/cache.h \
	daemon/files/sound.c \
	daemon/files/sound.h \
	daemon/files/views.c \
	daemon/files/views.h
