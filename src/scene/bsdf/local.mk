# scattering data from XML files
librad_a_SOURCES += \
	src/scene/bsdf/bsdf.c \
	src/scene/bsdf/bsdf.h \
	src/scene/bsdf/bsdfimpl.h \
	src/scene/bsdf/bsdfmatrix.c \
	src/scene/bsdf/bsdftree.c \
	src/scene/bsdf/bsdftree.h \
	src/scene/bsdf/bsdftreeread.c \
	src/scene/bsdf/bsdfxml.c
