# a job cut into units, by each of the ways to share
libdaemon_a_SOURCES += \
	daemon/partition/partition.c \
	daemon/partition/partition.h \
	daemon/partition/partition_impl.h \
	daemon/partition/partition_lines.c \
	daemon/partition/partition_lines.h \
	daemon/partition/partition_region.c \
	daemon/partition/partition_run.c \
	daemon/partition/partition_table.c \
	daemon/partition/partition_window.c
