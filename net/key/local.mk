# keys: their files, orders to change them, the ring that a coordinator takes
libnet_a_SOURCES += \
	net/key/key.c \
	net/key/key.h \
	net/key/keyfile.c \
	net/key/keyfile.h \
	net/key/keyorder.c \
	net/key/keyorder.h \
	net/key/keyring.c \
	net/key/keyring.h
