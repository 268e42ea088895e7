# functions of numbers that have the same bits on every machine
librad_a_SOURCES += \
	src/arith/angle.h \
	src/arith/bits.h \
	src/arith/elementary.c \
	src/arith/elementary.h \
	src/arith/expf.h
