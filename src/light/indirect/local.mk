# the ambient cache
librad_a_SOURCES += \
	src/light/indirect/ambient.c \
	src/light/indirect/ambient.h \
	src/light/indirect/ambient_apply.c \
	src/light/indirect/ambient_find.c \
	src/light/indirect/ambient_impl.h \
	src/light/indirect/ambserving.c \
	src/light/indirect/ambserving.h \
	src/light/indirect/ambshape.c \
	src/light/indirect/ambshape.h \
	src/light/indirect/ambsmooth.c \
	src/light/indirect/ambsmooth.h \
	src/light/indirect/ambtile.c \
	src/light/indirect/ambtile.h
