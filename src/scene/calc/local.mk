# the language of functions
librad_a_SOURCES += \
	src/scene/calc/calc.c \
	src/scene/calc/calc.h \
	src/scene/calc/calcargs.c \
	src/scene/calc/calceval.c \
	src/scene/calc/calcimpl.h \
	src/scene/calc/calcinit.c \
	src/scene/calc/calcinline.c \
	src/scene/calc/calclamp.c \
	src/scene/calc/calclib.c \
	src/scene/calc/calcmemo.c \
	src/scene/calc/calcname.c \
	src/scene/calc/calcops.h \
	src/scene/calc/calcparse.c \
	src/scene/calc/calcprism.c \
	src/scene/calc/calcsame.c
