# the ambient cache and its hemispheres
librad_a_SOURCES += \
	src/light/indirect/ambcache.c \
	src/light/indirect/ambcache.h \
	src/light/indirect/ambfind.c \
	src/light/indirect/ambient.c \
	src/light/indirect/ambient.h \
	src/light/indirect/ambpool.c \
	src/light/indirect/ambpool.h \
	src/light/indirect/ambread.c \
	src/light/indirect/ambread.h \
	src/light/indirect/ambshape.c \
	src/light/indirect/ambshape.h \
	src/light/indirect/ambsmooth.c \
	src/light/indirect/ambsmooth.h \
	src/light/indirect/ambtile.c \
	src/light/indirect/ambtile.h \
	src/light/indirect/ambtree.h \
	src/light/indirect/bright.c \
	src/light/indirect/bright.h \
	src/light/indirect/gradient.c \
	src/light/indirect/gradient.h \
	src/light/indirect/hemisphere.c \
	src/light/indirect/hemisphere.h
