# primary rays: views, the quincunx sampling, frames
librad_a_SOURCES += \
	src/picture/doubt.c \
	src/picture/doubt.h \
	src/picture/estimate.c \
	src/picture/estimate.h \
	src/picture/facts.c \
	src/picture/facts.h \
	src/picture/frame.c \
	src/picture/frame.h \
	src/picture/paint.c \
	src/picture/paint.h \
	src/picture/path.c \
	src/picture/path.h \
	src/picture/quincunx.c \
	src/picture/quincunx.h \
	src/picture/view.c \
	src/picture/view.h
