# sensor points, laid out as pixels of a picture
librad_a_SOURCES += \
	src/points/curve.c \
	src/points/curve.h \
	src/points/points.c \
	src/points/points.h
