# what radweb knows of the cluster: asked for, kept, made text and pictures of
libweb_a_SOURCES += \
	daemon/observer/blob.c \
	daemon/observer/blob.h \
	daemon/observer/history.c \
	daemon/observer/history.h \
	daemon/observer/markup.c \
	daemon/observer/markup.h \
	daemon/observer/model.c \
	daemon/observer/model.h \
	daemon/observer/picture.c \
	daemon/observer/picture.h \
	daemon/observer/session.c \
	daemon/observer/session.h \
	daemon/observer/units.c \
	daemon/observer/units.h \
	daemon/observer/watch.c \
	daemon/observer/watch.h
