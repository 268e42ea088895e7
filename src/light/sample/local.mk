# where to look: on light sources, and all around
librad_a_SOURCES += \
	src/light/sample/contour.c \
	src/light/sample/contour.h \
	src/light/sample/contrast.c \
	src/light/sample/contrast.h \
	src/light/sample/disk.c \
	src/light/sample/disk.h \
	src/light/sample/patch.c \
	src/light/sample/patch.h \
	src/light/sample/polytree.c \
	src/light/sample/polytree.h \
	src/light/sample/quad.c \
	src/light/sample/quad.h \
	src/light/sample/sample.c \
	src/light/sample/sample.h \
	src/light/sample/spot.c \
	src/light/sample/spot.h
