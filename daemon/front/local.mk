# what users ask of the coordinator, and how much they may have
libdaemon_a_SOURCES += \
	daemon/front/coord.c \
	daemon/front/coord.h \
	daemon/front/listing.c \
	daemon/front/listing.h \
	daemon/front/report.c \
	daemon/front/report.h \
	daemon/front/request.c \
	daemon/front/request.h
