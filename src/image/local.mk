# picture files and pixels
librad_a_SOURCES += \
	src/image/edge.c \
	src/image/edge.h \
	src/image/filter.c \
	src/image/filter.h \
	src/image/hdr.c \
	src/image/hdr.h \
	src/image/hdrimpl.h \
	src/image/hdrread.c \
	src/image/metric.c \
	src/image/metric.h \
	src/image/pixel.h \
	src/image/png.c \
	src/image/png.h \
	src/image/raster.c \
	src/image/raster.h \
	src/image/spectrum.c \
	src/image/spectrum.h \
	src/image/srgb.c \
	src/image/srgb.h
