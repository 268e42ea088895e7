# connections, for daemons and clients: addresses, keys, TLS
libproto_a_SOURCES += \
	net/inifile.c \
	net/inifile.h \
	net/keyfile.c \
	net/keyfile.h \
	net/keyorder.c \
	net/keyorder.h \
	net/tls.c \
	net/tls.h
libdaemon_a_SOURCES += \
	net/address.c \
	net/address.h \
	net/conn.c \
	net/conn.h \
	net/dial.c \
	net/dial.h \
	net/fair.c \
	net/fair.h \
	net/gate.c \
	net/gate.h \
	net/handshake.c \
	net/handshake.h \
	net/keyring.c \
	net/keyring.h \
	net/listen.c \
	net/listen.h \
	net/log.c \
	net/log.h
