# ambient records and where they are kept
librad_a_SOURCES += \
	src/light/record/ambcache.c \
	src/light/record/ambcache.h \
	src/light/record/ambcache_find.c \
	src/light/record/ambcache_impl.h \
	src/light/record/ambpool.c \
	src/light/record/ambpool.h \
	src/light/record/ambread.c \
	src/light/record/ambread.h \
	src/light/record/ambread_impl.h \
	src/light/record/ambread_settle.c \
	src/light/record/ambrec.h
