# Measurements: `make bench`, never part of the tests.
# BENCH_SCENE and BENCH_VIEW choose another scene than the generated one.
EXTRA_PROGRAMS += bench/kernel
CLEANFILES += bench/kernel$(EXEEXT)

bench_kernel_SOURCES = bench/kernel.c
bench_kernel_LDADD = $(LIBRAD)

BENCH_SCENE =
BENCH_VIEW =

.PHONY: bench bench-kernel bench-hosts
bench: bench-kernel bench-hosts
bench-kernel: bench/kernel$(EXEEXT)
	$(MKDIR_P) bench/results
	bench/kernel$(EXEEXT) $(BENCH_SCENE) $(BENCH_VIEW) \
		>bench/results/kernel.txt
	cat bench/results/kernel.txt

# The ways to share a picture on emulated workstations; HOSTS_FLAGS are options
# of bench/hosts.sh.
HOSTS_FLAGS =
dist_noinst_SCRIPTS += bench/hosts.sh
EXTRA_DIST += bench/hosts.awk bench/stats.awk
bench-hosts: radcoord$(EXEEXT) radd$(EXEEXT) radsubmit$(EXEEXT) radctl$(EXEEXT)
	$(srcdir)/bench/hosts.sh $(HOSTS_FLAGS) . $(BENCH_SCENE) $(BENCH_VIEW)

# Against rpict, where that is on PATH: bench/versus.sh says how to call it.
dist_noinst_SCRIPTS += bench/versus.sh
