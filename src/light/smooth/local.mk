# the noise of neighbouring measurements of irradiance, averaged
librad_a_SOURCES += \
	src/light/smooth/quadric.c \
	src/light/smooth/quadric.h \
	src/light/smooth/smooth.c \
	src/light/smooth/smooth.h
