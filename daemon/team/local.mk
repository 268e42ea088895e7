# threads that go over one unit together
libdaemon_a_SOURCES += \
	daemon/team/team.c \
	daemon/team/team.h \
	daemon/team/team_blocks.c \
	daemon/team/team_help.c \
	daemon/team/team_impl.h \
	daemon/team/team_lend.c \
	daemon/team/team_line.c \
	daemon/team/team_member.c \
	daemon/team/team_member.h \
	daemon/team/team_spec.h \
	daemon/team/team_sweep.c
