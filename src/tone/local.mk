# pictures as a screen or an eye shows them
librad_a_SOURCES += \
	src/tone/eye.c \
	src/tone/eye.h \
	src/tone/falsecolour.c \
	src/tone/falsecolour.h \
	src/tone/human.c \
	src/tone/human.h \
	src/tone/legend.c \
	src/tone/legend.h \
	src/tone/primaries.c \
	src/tone/primaries.h \
	src/tone/screen.c \
	src/tone/screen.h \
	src/tone/tone.c \
	src/tone/tone.h
