# a cluster of whole daemons, without sockets and disks, under a seed
UNIT_TESTS += \
	tests/sim/check_sim

tests_sim_check_sim_SOURCES = \
	tests/sim/check_sim.c \
	tests/sim/child.c \
	tests/sim/client.c \
	tests/sim/cluster.c \
	tests/sim/cluster.h \
	tests/sim/disk.c \
	tests/sim/event.c \
	tests/sim/event.h \
	tests/sim/fault.c \
	tests/sim/fibre.c \
	tests/sim/fibre.h \
	tests/sim/net.c \
	tests/sim/net.h \
	tests/sim/picture.c \
	tests/sim/task.c \
	tests/sim/task.h \
	tests/sim/tiles.c
