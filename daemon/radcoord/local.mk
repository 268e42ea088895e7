# the coordinator daemon: the shell around the queue
radcoord_SOURCES = \
	daemon/radcoord/radcoord.c \
	daemon/radcoord/radcoord_conf.c \
	daemon/radcoord/radcoord_conns.c \
	daemon/radcoord/radcoord_impl.h \
	daemon/radcoord/radcoord_keys.c \
	daemon/radcoord/radcoord_store.c
