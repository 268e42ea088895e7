# Measurements: `make bench`, never part of the tests.
# BENCH_SCENE and BENCH_VIEW choose another scene than the generated one.
EXTRA_PROGRAMS += bench/kernel
CLEANFILES += bench/kernel$(EXEEXT)

bench_kernel_SOURCES = bench/kernel.c
bench_kernel_LDADD = $(LIBRAD)

BENCH_SCENE =
BENCH_VIEW =

.PHONY: bench bench-kernel
bench: bench-kernel
bench-kernel: bench/kernel$(EXEEXT)
	$(MKDIR_P) bench/results
	bench/kernel$(EXEEXT) $(BENCH_SCENE) $(BENCH_VIEW) \
		>bench/results/kernel.txt
	cat bench/results/kernel.txt

# Against rpict, where that is on PATH: bench/versus.sh says how to call it.
dist_noinst_SCRIPTS += bench/versus.sh
