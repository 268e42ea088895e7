# the coordinator's state folder: files by hash, jobs, rows; radctl check
libdaemon_a_SOURCES += \
	daemon/store/statecheck.c \
	daemon/store/statecheck.h \
	daemon/store/store.c \
	daemon/store/store.h \
	daemon/store/store_arrive.c \
	daemon/store/store_files.c \
	daemon/store/store_impl.h \
	daemon/store/store_jobs.c \
	daemon/store/store_passes.c \
	daemon/store/store_read.c \
	daemon/store/store_read.h \
	daemon/store/store_recover.c \
	daemon/store/store_rows.c \
	daemon/store/store_submit.c \
	daemon/store/store_task.c
