# files of jobs: rows as they come, pictures
libdaemon_a_SOURCES += \
	daemon/folder/coarse.c \
	daemon/folder/coarse.h \
	daemon/folder/filtered.c \
	daemon/folder/filtered.h \
	daemon/folder/folder.c \
	daemon/folder/folder.h \
	daemon/folder/folder_cache.c \
	daemon/folder/folder_impl.h \
	daemon/folder/folder_picture.c \
	daemon/folder/folder_rows.c \
	daemon/folder/folder_take.c \
	daemon/folder/room.c \
	daemon/folder/room.h \
	daemon/folder/rowcheck.c \
	daemon/folder/rowcheck.h \
	daemon/folder/rows.c \
	daemon/folder/rows.h \
	daemon/folder/rows_picture.c
