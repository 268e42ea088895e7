# what a scene is read from: words, objects of its text, fonts, data, bundles
librad_a_SOURCES += \
	src/scene/file/bundle.c \
	src/scene/file/bundle.h \
	src/scene/file/data.c \
	src/scene/file/data.h \
	src/scene/file/font.c \
	src/scene/file/font.h \
	src/scene/file/lex.c \
	src/scene/file/lex.h \
	src/scene/file/parse.c \
	src/scene/file/parse.h \
	src/scene/file/specpict.c \
	src/scene/file/specpict.h
