# text and files to objects
librad_a_SOURCES += \
	src/scene/check.c \
	src/scene/meshfile.c \
	src/scene/meshfile.h \
	src/scene/octfile.c \
	src/scene/octfile.h \
	src/scene/octin.c \
	src/scene/octin.h \
	src/scene/octreal.h \
	src/scene/octree.c \
	src/scene/octree.h \
	src/scene/octwrite.c \
	src/scene/otype.c \
	src/scene/otype.def \
	src/scene/otype.h \
	src/scene/overlap.c \
	src/scene/overlap.h \
	src/scene/part.c \
	src/scene/part.h \
	src/scene/reach.c \
	src/scene/scene.c \
	src/scene/scene.h
