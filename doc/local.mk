# What the programs' users and authors read beyond man/.
dist_doc_DATA = \
	CONTRIBUTING.md \
	LICENSE \
	NEWS \
	README.md

# in a folder of its own: README.md links to doc/...
pagesdir = $(docdir)/doc
dist_pages_DATA = \
	doc/accuracy.md \
	doc/architecture.md \
	doc/differences.md \
	doc/glossary.md \
	doc/measured.md \
	doc/operations.md \
	doc/performance.md \
	doc/pixel.md \
	doc/protocol.md \
	doc/radweb.png \
	doc/reading-room.png \
	doc/security.md \
	doc/speed-error.png \
	doc/tried.md
