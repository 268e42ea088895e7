# libproto, the codec of the protocol: bytes only
noinst_LIBRARIES += libproto.a
libproto_a_CFLAGS = $(AM_CFLAGS)
libproto_a_SOURCES = \
	proto/ambshare.c \
	proto/ambshare.h \
	proto/codec.c \
	proto/codec.h \
	proto/counts.c \
	proto/frame.c \
	proto/frame.h \
	proto/message.c \
	proto/message.def \
	proto/message.h \
	proto/msg_basics.h \
	proto/msg_job.c \
	proto/msg_job.h \
	proto/msg_lending.h \
	proto/msg_order.c \
	proto/msg_order.h \
	proto/msg_passes.c \
	proto/msg_passes.h \
	proto/msg_peer.c \
	proto/msg_peer.h \
	proto/msg_session.c \
	proto/msg_session.h \
	proto/msg_sharing.c \
	proto/msg_sharing.h \
	proto/msg_store.c \
	proto/msg_store.h \
	proto/msg_work.c \
	proto/msg_work.h \
	proto/wire.c \
	proto/wire.h

# what a program that uses libproto links with; librad (for its error codes)
# comes after it
LIBPROTO = libproto.a
