# what all of the renderer stands on: errors, memory, vectors, colour, options
librad_a_SOURCES += \
	src/base/arena.c \
	src/base/arena.h \
	src/base/bands.c \
	src/base/bands.h \
	src/base/bits.h \
	src/base/color.h \
	src/base/error.c \
	src/base/error.h \
	src/base/files.c \
	src/base/files.h \
	src/base/help.c \
	src/base/help.h \
	src/base/hex.c \
	src/base/hex.h \
	src/base/list.c \
	src/base/list.h \
	src/base/number.c \
	src/base/number.h \
	src/base/output.c \
	src/base/output.h \
	src/base/params.c \
	src/base/params.h \
	src/base/rng.h \
	src/base/sha.c \
	src/base/sha.h \
	src/base/text.c \
	src/base/text.h \
	src/base/vec.h \
	src/base/xform.c \
	src/base/xform.h
