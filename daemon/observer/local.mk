# radweb's requests to the coordinator, and the cluster by the answers
libweb_a_SOURCES += \
	daemon/observer/blob.c \
	daemon/observer/blob.h \
	daemon/observer/model.c \
	daemon/observer/model.h \
	daemon/observer/session.c \
	daemon/observer/session.h \
	daemon/observer/watch.c \
	daemon/observer/watch.h
