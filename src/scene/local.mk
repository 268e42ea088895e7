# text and files to objects
librad_a_SOURCES += \
	src/scene/bundle.c \
	src/scene/bundle.h \
	src/scene/check.c \
	src/scene/data.c \
	src/scene/data.h \
	src/scene/font.c \
	src/scene/font.h \
	src/scene/lex.c \
	src/scene/lex.h \
	src/scene/meshfile.c \
	src/scene/meshfile.h \
	src/scene/otype.c \
	src/scene/otype.def \
	src/scene/otype.h \
	src/scene/parse.c \
	src/scene/parse.h \
	src/scene/part.c \
	src/scene/part.h \
	src/scene/reach.c \
	src/scene/scene.c \
	src/scene/scene.h
