# rad's variables to a job
libclient_a_SOURCES += \
	client/rif/rif.c \
	client/rif/rif.h \
	client/rif/rif_line.c \
	client/rif/rif_line.h \
	client/rif/rif_rules.c \
	client/rif/rif_rules.h \
	client/rif/rif_view.c \
	client/rif/rif_view.h \
	client/rif/rifjob.c \
	client/rif/rifjob.h
