# the ambient cache
librad_a_SOURCES += \
	src/light/indirect/ambcache.c \
	src/light/indirect/ambcache.h \
	src/light/indirect/ambcache_find.c \
	src/light/indirect/ambcache_impl.h \
	src/light/indirect/ambient.c \
	src/light/indirect/ambient.h \
	src/light/indirect/ambient_apply.c \
	src/light/indirect/ambient_find.c \
	src/light/indirect/ambient_impl.h \
	src/light/indirect/ambpool.c \
	src/light/indirect/ambpool.h \
	src/light/indirect/ambread.c \
	src/light/indirect/ambread.h \
	src/light/indirect/ambread_impl.h \
	src/light/indirect/ambread_settle.c \
	src/light/indirect/ambserving.c \
	src/light/indirect/ambserving.h \
	src/light/indirect/ambshape.c \
	src/light/indirect/ambshape.h \
	src/light/indirect/ambsmooth.c \
	src/light/indirect/ambsmooth.h \
	src/light/indirect/ambtile.c \
	src/light/indirect/ambtile.h
