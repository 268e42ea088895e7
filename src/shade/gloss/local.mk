# materials that reflect or pass gloss
librad_a_SOURCES += \
	src/shade/gloss/aniso.c \
	src/shade/gloss/aniso.h \
	src/shade/gloss/ashik.c \
	src/shade/gloss/ashik.h \
	src/shade/gloss/brdf.c \
	src/shade/gloss/brdf.h \
	src/shade/gloss/gloss.c \
	src/shade/gloss/gloss.h \
	src/shade/gloss/normal.c \
	src/shade/gloss/normal.h \
	src/shade/gloss/scatter.c \
	src/shade/gloss/scatter.h \
	src/shade/gloss/wgmd.c \
	src/shade/gloss/wgmd.h
