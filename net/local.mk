# libnet, connections for daemons and clients: addresses, TLS, keys, the log
noinst_LIBRARIES += libnet.a
libnet_a_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(INIH_CFLAGS) $(SSL_CFLAGS)
libnet_a_SOURCES = \
	net/address.c \
	net/address.h \
	net/conn.c \
	net/conn.h \
	net/conn_impl.h \
	net/conn_in.c \
	net/conn_out.c \
	net/conn_stream.c \
	net/conn_stream.h \
	net/dial.c \
	net/dial.h \
	net/fair.c \
	net/fair.h \
	net/gate.c \
	net/gate.h \
	net/handshake.c \
	net/handshake.h \
	net/inifile.c \
	net/inifile.h \
	net/listen.c \
	net/listen.h \
	net/log.c \
	net/log.h \
	net/lookup.c \
	net/lookup.h \
	net/tls.c \
	net/tls.h
include net/key/local.mk

# what a program that uses libnet links with, before $(LIBRAD)
LIBNET = libnet.a $(LIBPROTO) $(UV_LIBS) $(INIH_LIBS) $(SSL_LIBS)
