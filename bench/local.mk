# Measurements: `make bench`, never part of the tests.
# BENCH_SCENE and BENCH_VIEW choose another scene than the generated one.
EXTRA_PROGRAMS += bench/kernel
CLEANFILES += bench/kernel$(EXEEXT)

bench_kernel_SOURCES = bench/kernel.c bench/tool.h
bench_kernel_LDADD = $(LIBRAD)

EXTRA_PROGRAMS += bench/ambient
CLEANFILES += bench/ambient$(EXEEXT)

bench_ambient_SOURCES = bench/ambient.c bench/tool.h
bench_ambient_LDADD = $(LIBCLIENT) $(LIBRAD)

EXTRA_PROGRAMS += bench/passes
CLEANFILES += bench/passes$(EXEEXT)

bench_passes_SOURCES = bench/passes.c bench/tool.h
bench_passes_LDADD = $(LIBCLIENT) $(LIBRAD)

BENCH_SCENE =
BENCH_VIEW =

# AMBIENT_FLAGS are options of bench/ambient, rendering options among them.
AMBIENT_FLAGS =
.PHONY: bench bench-ambient bench-kernel bench-hosts bench-sim bench-error \
	bench-eta
bench: bench-ambient bench-kernel bench-sim bench-hosts bench-error bench-eta
bench-kernel: bench/kernel$(EXEEXT)
	$(MKDIR_P) bench/results
	bench/kernel$(EXEEXT) $(BENCH_SCENE) $(BENCH_VIEW) \
		>bench/results/kernel.txt
	cat bench/results/kernel.txt
bench-ambient: bench/ambient$(EXEEXT)
	$(MKDIR_P) bench/results
	bench/ambient$(EXEEXT) $(AMBIENT_FLAGS) $(BENCH_SCENE) $(BENCH_VIEW) \
		>bench/results/ambient.txt
	cat bench/results/ambient.txt

# The ways to share a picture on emulated workstations; HOSTS_FLAGS are options
# of bench/hosts.sh.
HOSTS_FLAGS =
dist_noinst_SCRIPTS += bench/hosts.sh bench/quality.sh
EXTRA_DIST += bench/hosts.awk bench/lib.sh bench/stats.awk
bench-hosts: bench/sim/sim$(EXEEXT) radcoord$(EXEEXT) radd$(EXEEXT) radsubmit$(EXEEXT) radctl$(EXEEXT)
	$(srcdir)/bench/hosts.sh $(HOSTS_FLAGS) . $(BENCH_SCENE) $(BENCH_VIEW)

# Speed against error of indirect light; ERROR_FLAGS are options of
# bench/speed-error.sh.
ERROR_FLAGS =
dist_noinst_SCRIPTS += bench/speed-error.sh
EXTRA_DIST += bench/speed-error.awk bench/speed-error.gnuplot
bench-error: radcoord$(EXEEXT) radd$(EXEEXT) radsubmit$(EXEEXT) raderr$(EXEEXT)
	$(srcdir)/bench/speed-error.sh $(ERROR_FLAGS) .

# What is said of a job beforehand, against what comes; ETA_FLAGS are options of
# bench/eta.sh.
ETA_FLAGS =
dist_noinst_SCRIPTS += bench/eta.sh
bench-eta: radcoord$(EXEEXT) radd$(EXEEXT) radsubmit$(EXEEXT) raderr$(EXEEXT)
	$(srcdir)/bench/eta.sh $(ETA_FLAGS) .

# The scheduler with simulated hosts; SIM_FLAGS are options of bench/sim/sim,
# a statistics file among them.
check_PROGRAMS += bench/sim/sim
bench_sim_sim_SOURCES = \
	bench/sim/cluster.c \
	bench/sim/cluster.h \
	bench/sim/host.c \
	bench/sim/host.h \
	bench/sim/host_errand.c \
	bench/sim/host_impl.h \
	bench/sim/host_pass.c \
	bench/sim/host_radd.c \
	bench/sim/host_rows.c \
	bench/sim/host_tiles.c \
	bench/sim/host_time.c \
	bench/sim/map.c \
	bench/sim/map.h \
	bench/sim/sim.c \
	bench/sim/tiles.c \
	bench/sim/tiles.h \
	tests/sim/event.c \
	tests/sim/event.h \
	tests/sim/fibre.c \
	tests/sim/fibre.h \
	tests/sim/task.c \
	tests/sim/task.h
bench_sim_sim_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
bench_sim_sim_LDFLAGS = $(AM_LDFLAGS) -Wl,--wrap=uv_cond_wait \
	-Wl,--wrap=uv_cond_signal -Wl,--wrap=uv_cond_broadcast
bench_sim_sim_LDADD = $(LIBDAEMON) $(LIBCLIENT) $(LIBRAD)
SIM_FLAGS =
bench-sim: bench/sim/sim$(EXEEXT)
	$(MKDIR_P) bench/results
	bench/sim/sim$(EXEEXT) --size=3840x2160 $(SIM_FLAGS) \
		--plot=bench/results/sim.png >bench/results/sim.txt
	cat bench/results/sim.txt

# Against rpict, where that is on PATH: the scripts say how to call them.
dist_noinst_SCRIPTS += bench/rpict.sh
EXTRA_DIST += bench/peep.rad bench/scenes.rows
dist_noinst_SCRIPTS += bench/versus.sh
