# light sources and their shadows
librad_a_SOURCES += \
	src/light/direct/contour.c \
	src/light/direct/contour.h \
	src/light/direct/image.c \
	src/light/direct/image.h \
	src/light/direct/patch.c \
	src/light/direct/patch.h \
	src/light/direct/polytree.c \
	src/light/direct/polytree.h \
	src/light/direct/pretest.c \
	src/light/direct/quad.c \
	src/light/direct/quad.h \
	src/light/direct/shadow.c \
	src/light/direct/shape.c \
	src/light/direct/source.c \
	src/light/direct/source.h \
	src/light/direct/sources.h \
	src/light/direct/spot.c \
	src/light/direct/spot.h \
	src/light/direct/virtual.c \
	src/light/direct/virtual.h \
	src/light/direct/way.c \
	src/light/direct/way.h
