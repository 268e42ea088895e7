# libproto, the codec of the protocol: bytes only
noinst_LIBRARIES += libproto.a
libproto_a_CFLAGS = $(AM_CFLAGS) $(SSL_CFLAGS)
libproto_a_SOURCES = \
	proto/codec.c \
	proto/codec.h \
	proto/frame.c \
	proto/frame.h \
	proto/keyfile.c \
	proto/keyfile.h \
	proto/message.c \
	proto/message.def \
	proto/message.h \
	proto/sharing.c \
	proto/tls.c \
	proto/tls.h \
	proto/wire.c \
	proto/wire.h

# what a program that uses libproto links with; librad (for its error codes)
# comes after it
LIBPROTO = libproto.a $(SSL_LIBS)
