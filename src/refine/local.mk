# stages of jobs that go on until their pictures are good enough
librad_a_SOURCES += \
	src/refine/recheck.c \
	src/refine/recheck.h \
	src/refine/refine.c \
	src/refine/refine.h
