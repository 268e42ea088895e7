# materials
librad_a_SOURCES += \
	src/shade/antimatter.c \
	src/shade/antimatter.h \
	src/shade/compile.c \
	src/shade/dielectric.c \
	src/shade/dielectric.h \
	src/shade/families.c \
	src/shade/glass.c \
	src/shade/glass.h \
	src/shade/mirror.c \
	src/shade/mirror.h \
	src/shade/mist.c \
	src/shade/mist.h \
	src/shade/prism.c \
	src/shade/prism.h
