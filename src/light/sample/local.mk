# where on a light source to look: patches and their sizes
librad_a_SOURCES += \
	src/light/sample/contour.c \
	src/light/sample/contour.h \
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
