# a worker's decisions: jobs, links to other workers, the cache of files
libdaemon_a_SOURCES += \
	daemon/worker/gather.c \
	daemon/worker/gather.h \
	daemon/worker/link.c \
	daemon/worker/link.h \
	daemon/worker/peer.c \
	daemon/worker/peer.h \
	daemon/worker/relay.c \
	daemon/worker/relay.h \
	daemon/worker/state.h \
	daemon/worker/wjob.c \
	daemon/worker/wjob.h \
	daemon/worker/worker.c \
	daemon/worker/worker.h \
	daemon/worker/worker_child.c \
	daemon/worker/worker_coord.c \
	daemon/worker/worker_end.c \
	daemon/worker/worker_files.c \
	daemon/worker/worker_files.h \
	daemon/worker/worker_post.c \
	daemon/worker/worker_says.h
