# What the programs' users and authors read beyond man/.
dist_doc_DATA = \
	CONTRIBUTING.md \
	LICENSE \
	NEWS \
	README.md \
	doc/accuracy.md \
	doc/architecture.md \
	doc/differences.md \
	doc/glossary.md \
	doc/measured.md \
	doc/operations.md \
	doc/performance.md \
	doc/pixel.md \
	doc/protocol.md \
	doc/security.md \
	doc/tried.md
