# The pages.  Paths in them are the usual ones of a system.
dist_man_MANS += \
	man/radctl.1 \
	man/raderr.1 \
	man/radscene.1 \
	man/radsubmit.1
