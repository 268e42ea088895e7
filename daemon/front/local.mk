# events of the coordinator, and requests of its users
libdaemon_a_SOURCES += \
	daemon/front/coord.c \
	daemon/front/coord.h \
	daemon/front/coord_files.c \
	daemon/front/coord_files.h \
	daemon/front/delivery.c \
	daemon/front/delivery.h \
	daemon/front/intake.c \
	daemon/front/intake.h \
	daemon/front/listing.c \
	daemon/front/listing.h \
	daemon/front/reply.c \
	daemon/front/reply.h \
	daemon/front/report.c \
	daemon/front/report.h \
	daemon/front/request.c \
	daemon/front/request.h \
	daemon/front/workers.c \
	daemon/front/workers.h
