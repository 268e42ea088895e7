# the database of the state folder
libdaemon_a_SOURCES += \
	daemon/journal/journal.c \
	daemon/journal/journal.h \
	daemon/journal/journal_impl.h \
	daemon/journal/journal_life.c \
	daemon/journal/journal_put.c \
	daemon/journal/journal_read.c \
	daemon/journal/journal_sql.c \
	daemon/journal/statedir.c \
	daemon/journal/statedir.h
