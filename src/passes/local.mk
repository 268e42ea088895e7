# the ambient cache in passes: which there are, what their tiles make
librad_a_SOURCES += \
	src/passes/parts.c \
	src/passes/parts.h \
	src/passes/passcost.c \
	src/passes/passcost.h \
	src/passes/passes.c \
	src/passes/passes.h \
	src/passes/passplan.c \
	src/passes/passplan.h
