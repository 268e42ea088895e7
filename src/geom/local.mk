# where rays meet surfaces
librad_a_SOURCES += \
	src/geom/bvh.c \
	src/geom/bvh.h \
	src/geom/cone.c \
	src/geom/geom.c \
	src/geom/geom.h \
	src/geom/kernel.c \
	src/geom/kernel.h \
	src/geom/line.c \
	src/geom/line.h \
	src/geom/meshed.c \
	src/geom/meshed.h \
	src/geom/place.c \
	src/geom/place.h \
	src/geom/polygon.c \
	src/geom/polygon.h \
	src/geom/prim.c \
	src/geom/prim.h \
	src/geom/ring.c \
	src/geom/sphere.c \
	src/geom/walk.inc \
	src/geom/walk_avx2.c \
	src/geom/walk_avx512.c \
	src/geom/walk_neon.c \
	src/geom/walk_plain.c \
	src/geom/walk_sse2.c
