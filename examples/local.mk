# The example scene and the script that renders it.
examplesdir = $(pkgdatadir)/examples/reading-room
dist_examples_DATA = \
	examples/reading-room/books.awk \
	examples/reading-room/boxes.awk \
	examples/reading-room/fast.opt \
	examples/reading-room/furniture.txt \
	examples/reading-room/good.opt \
	examples/reading-room/room.rad \
	examples/reading-room/room.vf \
	examples/reading-room/shelves.txt

EXTRA_DIST += examples/README.md
dist_noinst_SCRIPTS += examples/demo
