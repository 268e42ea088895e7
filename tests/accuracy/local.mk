# The renderer against closed forms; `make accuracy` prints the table.
check_PROGRAMS += tests/accuracy/accuracy
TESTS += tests/accuracy/accuracy

tests_accuracy_accuracy_SOURCES = \
	tests/accuracy/accuracy.h \
	tests/accuracy/bounce.c \
	tests/accuracy/hard.c \
	tests/accuracy/hard.h \
	tests/accuracy/light.c \
	tests/accuracy/main.c \
	tests/accuracy/matter.c \
	tests/accuracy/sky.c \
	tests/accuracy/stage.c \
	tests/accuracy/stage.h \
	tests/closed_mesh.h \
	tests/lambert.h
tests_accuracy_accuracy_LDADD = $(LIBRAD)

.PHONY: accuracy
accuracy: tests/accuracy/accuracy$(EXEEXT)
	tests/accuracy/accuracy$(EXEEXT) --table
