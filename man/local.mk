# The pages.  Paths in them are the usual ones of a system.
dist_man_MANS += \
	man/radcoord.8 \
	man/radcoord.conf.5 \
	man/radctl.1 \
	man/radd.8 \
	man/radd.conf.5 \
	man/raderr.1 \
	man/radscene.1 \
	man/radsubmit.1
