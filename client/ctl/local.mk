# radctl
radctl_SOURCES = \
	client/ctl/ctl.c \
	client/ctl/ctl.h \
	client/ctl/ctl_admin.c \
	client/ctl/ctl_enroll.c \
	client/ctl/ctl_fetch.c \
	client/ctl/ctl_job.c \
	client/ctl/ctl_list.c \
	client/ctl/ctl_top.c \
	client/ctl/radctl.c
libclient_a_SOURCES += \
	client/ctl/ctl_words.c \
	client/ctl/row.h \
	client/ctl/top.c \
	client/ctl/top.h \
	client/ctl/top_lines.c \
	client/ctl/top_rows.c \
	client/ctl/top_rows.h
