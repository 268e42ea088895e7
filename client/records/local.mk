# files of ambient records
libclient_a_SOURCES += \
	client/records/ambfile.c \
	client/records/ambfile.h \
	client/records/amblist.c \
	client/records/amblist.h \
	client/records/records.c \
	client/records/records.h
