# what the clients have in common: words of a command line, what they say
libclient_a_SOURCES += \
	client/common/figure.c \
	client/common/figure.h \
	client/common/inputs.c \
	client/common/inputs.h \
	client/common/option.c \
	client/common/option.h \
	client/common/outname.c \
	client/common/outname.h \
	client/common/table.c \
	client/common/table.h \
	client/common/tell.c \
	client/common/tell.h \
	client/common/words.c \
	client/common/words.h
