# what radweb's pages are made of
libweb_a_SOURCES += \
	daemon/draw/assets.c \
	daemon/draw/assets.h \
	daemon/draw/chart.c \
	daemon/draw/chart.h \
	daemon/draw/history.c \
	daemon/draw/history.h \
	daemon/draw/markup.c \
	daemon/draw/markup.h \
	daemon/draw/picture.c \
	daemon/draw/picture.h \
	daemon/draw/units.c \
	daemon/draw/units.h
WEB_ASSETS = \
	daemon/draw/icon.svg \
	daemon/draw/page.js \
	daemon/draw/style.css
EXTRA_DIST += $(WEB_ASSETS)

# the assembler takes the files in
daemon/draw/libweb_a-assets.$(OBJEXT): $(WEB_ASSETS)
