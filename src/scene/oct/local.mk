# Radiance's octree, in files and made anew
librad_a_SOURCES += \
	src/scene/oct/octfile.c \
	src/scene/oct/octfile.h \
	src/scene/oct/octin.c \
	src/scene/oct/octin.h \
	src/scene/oct/octreal.h \
	src/scene/oct/octree.c \
	src/scene/oct/octree.h \
	src/scene/oct/octwrite.c \
	src/scene/oct/overlap.c \
	src/scene/oct/overlap.h
