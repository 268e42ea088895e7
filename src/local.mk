# librad, the renderer
noinst_LIBRARIES += librad.a
librad_a_CPPFLAGS = $(AM_CPPFLAGS)
librad_a_CFLAGS = $(AM_CFLAGS) $(PNG_CFLAGS) $(CRYPTO_CFLAGS)
librad_a_SOURCES = \
	src/base/arena.c \
	src/base/arena.h \
	src/base/color.h \
	src/base/error.c \
	src/base/error.h \
	src/base/files.c \
	src/base/files.h \
	src/base/rng.h \
	src/base/sha.c \
	src/base/sha.h \
	src/base/vec.h \
	src/geom/bvh.c \
	src/geom/bvh.h \
	src/geom/cone.c \
	src/geom/geom.c \
	src/geom/geom.h \
	src/geom/kernel.c \
	src/geom/kernel.h \
	src/geom/polygon.c \
	src/geom/prim.c \
	src/geom/prim.h \
	src/geom/ring.c \
	src/geom/sphere.c \
	src/geom/walk.h \
	src/geom/walk_avx2.c \
	src/geom/walk_avx512.c \
	src/geom/walk_neon.c \
	src/geom/walk_plain.c \
	src/geom/walk_sse2.c \
	src/light/ambcache.c \
	src/light/ambcache.h \
	src/light/ambient.c \
	src/light/ambient.h \
	src/light/gradient.c \
	src/light/gradient.h \
	src/light/hemisphere.c \
	src/light/hemisphere.h \
	src/light/polytree.c \
	src/light/polytree.h \
	src/light/sample.c \
	src/light/sample.h \
	src/light/shadow.c \
	src/light/shape.c \
	src/light/source.c \
	src/light/source.h \
	src/light/sources.h \
	src/light/spot.c \
	src/light/spot.h \
	src/picture/hdr.c \
	src/picture/hdr.h \
	src/picture/number.c \
	src/picture/number.h \
	src/picture/params.c \
	src/picture/params.h \
	src/picture/view.c \
	src/picture/view.h \
	src/scene/bundle.c \
	src/scene/bundle.h \
	src/scene/check.c \
	src/scene/font.c \
	src/scene/font.h \
	src/scene/lex.c \
	src/scene/lex.h \
	src/scene/otype.c \
	src/scene/otype.def \
	src/scene/otype.h \
	src/scene/parse.c \
	src/scene/parse.h \
	src/scene/scene.c \
	src/scene/scene.h \
	src/shade/dielectric.c \
	src/shade/dielectric.h \
	src/shade/emitter.c \
	src/shade/emitter.h \
	src/shade/glass.c \
	src/shade/glass.h \
	src/shade/job.c \
	src/shade/job.h \
	src/shade/material.c \
	src/shade/material.h \
	src/shade/normal.c \
	src/shade/normal.h \
	src/shade/ray.c \
	src/shade/ray.h \
	src/shade/text.c \
	src/shade/text.h

# what a program that uses librad links with
LIBRAD = librad.a $(PNG_LIBS) $(CRYPTO_LIBS)
