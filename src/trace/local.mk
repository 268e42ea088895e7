# a ray, a job, the table of materials
librad_a_SOURCES += \
	src/trace/asks.h \
	src/trace/job.c \
	src/trace/job.h \
	src/trace/kinds.h \
	src/trace/material.c \
	src/trace/material.h \
	src/trace/ray.c \
	src/trace/ray.h
