# patterns, textures and mixtures
librad_a_SOURCES += \
	src/pattern/effect.c \
	src/pattern/effect.h \
	src/pattern/expr.c \
	src/pattern/expr.h \
	src/pattern/func.c \
	src/pattern/func.h \
	src/pattern/mixture.c \
	src/pattern/mixture.h \
	src/pattern/spectral.c \
	src/pattern/spectral.h \
	src/pattern/stored.c \
	src/pattern/stored.h \
	src/pattern/table.c \
	src/pattern/table.h \
	src/pattern/text.c \
	src/pattern/text.h
