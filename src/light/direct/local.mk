# light sources and their shadows
librad_a_SOURCES += \
	src/light/direct/cover.c \
	src/light/direct/cover.h \
	src/light/direct/emitter.c \
	src/light/direct/emitter.h \
	src/light/direct/image.c \
	src/light/direct/image.h \
	src/light/direct/pretest.c \
	src/light/direct/shadow.c \
	src/light/direct/shape.c \
	src/light/direct/source.c \
	src/light/direct/source.h \
	src/light/direct/sources.h \
	src/light/direct/virtual.c \
	src/light/direct/virtual.h \
	src/light/direct/way.c \
	src/light/direct/way.h
