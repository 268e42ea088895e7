# librad, the renderer
noinst_LIBRARIES += librad.a
librad_a_CPPFLAGS = $(AM_CPPFLAGS)
librad_a_CFLAGS = $(AM_CFLAGS) $(PNG_CFLAGS) $(CRYPTO_CFLAGS) \
	$(EXPAT_CFLAGS)
librad_a_SOURCES =
include src/arith/local.mk
include src/base/local.mk
include src/image/local.mk
include src/tone/local.mk
include src/scene/local.mk
include src/scene/file/local.mk
include src/scene/calc/local.mk
include src/scene/bsdf/local.mk
include src/geom/local.mk
include src/trace/local.mk
include src/light/sample/local.mk
include src/light/direct/local.mk
include src/light/smooth/local.mk
include src/light/hemisphere/local.mk
include src/light/record/local.mk
include src/light/indirect/local.mk
include src/pattern/local.mk
include src/shade/gloss/local.mk
include src/shade/local.mk
include src/points/local.mk
include src/picture/local.mk
include src/passes/local.mk
include src/refine/local.mk

# what a program that uses librad links with
LIBRAD = librad.a $(PNG_LIBS) $(CRYPTO_LIBS) $(EXPAT_LIBS)
