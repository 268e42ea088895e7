# the child's strict units: what is done next
libdaemon_a_SOURCES += \
	daemon/strict/strict.c \
	daemon/strict/strict.h \
	daemon/strict/strict_edge.c \
	daemon/strict/strict_edge.h \
	daemon/strict/strict_facts.c \
	daemon/strict/strict_facts.h \
	daemon/strict/strict_guess.c \
	daemon/strict/strict_guess.h \
	daemon/strict/strict_loan.c \
	daemon/strict/strict_loan.h \
	daemon/strict/strict_order.c \
	daemon/strict/strict_order.h \
	daemon/strict/strict_out.c \
	daemon/strict/strict_out.h \
	daemon/strict/strict_pass.c \
	daemon/strict/strict_rank.c \
	daemon/strict/strict_rank.h \
	daemon/strict/strict_state.h \
	daemon/strict/strict_unit.c \
	daemon/strict/strict_unit.h
