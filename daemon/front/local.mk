# what users ask of the coordinator, and how much they may have
libdaemon_a_SOURCES += \
	daemon/front/fair.c \
	daemon/front/fair.h \
	daemon/front/known.c \
	daemon/front/known.h \
	daemon/front/listing.c \
	daemon/front/listing.h \
	daemon/front/owner.c \
	daemon/front/owner.h \
	daemon/front/quota.c \
	daemon/front/quota.h \
	daemon/front/report.c \
	daemon/front/report.h \
	daemon/front/request.c \
	daemon/front/request.h \
	daemon/front/stats.c \
	daemon/front/stats.h \
	daemon/front/uploads.c \
	daemon/front/uploads.h
