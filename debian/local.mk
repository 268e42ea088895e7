# file by file: packages that were built here leave theirs in this folder
EXTRA_DIST += \
	debian/changelog \
	debian/clean \
	debian/control \
	debian/copyright \
	debian/radcoord.install \
	debian/radcoord.postrm \
	debian/radcoord.sysusers \
	debian/radd-client.install \
	debian/radd-doc.install \
	debian/radd.install \
	debian/radd.postrm \
	debian/radd.sysusers \
	debian/radweb.install \
	debian/rules \
	debian/source/format
