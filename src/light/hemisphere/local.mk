# hemispheres: where their rays go, and what these tell
librad_a_SOURCES += \
	src/light/hemisphere/bright.c \
	src/light/hemisphere/bright.h \
	src/light/hemisphere/glint.h \
	src/light/hemisphere/gradient.c \
	src/light/hemisphere/gradient.h \
	src/light/hemisphere/guide.c \
	src/light/hemisphere/guide.h \
	src/light/hemisphere/hemisphere.c \
	src/light/hemisphere/hemisphere.h
