# Makefile - builds, tests, shows and installs nonsmooth.  `make help` lists the targets.
#
# Everything is made in build/.  Sources are found by wildcard: a new file needs no change here.
# Settings for the command line: CC, CFLAGS, LDFLAGS, PREFIX, DESTDIR, NGSPICE_SRC.

VERSION := 0.1.0
SOVERSION := 0

ifeq ($(origin CC),default)
CC := gcc
endif
CFLAGS ?= -O2 -g
PREFIX ?= /usr/local
B := build# where everything is made; other builds (sanitizers, coverage, clang) set it to a folder below

WARN := -Wall -Wextra -Wpedantic -Wconversion -Werror
LIBS := -llapacke -llapack -lblas -lm
ALL_CFLAGS = -std=c11 $(CFLAGS) $(WARN) -fPIC -MMD -MP -Iinclude

.DELETE_ON_ERROR:
.SECONDARY:
.DEFAULT_GOAL := all

# --- library ---------------------------------------------------------------------------------------------

SRC := $(wildcard src/*/*.c)
OBJ := $(SRC:%.c=$(B)/obj/%.o)

.PHONY: lib
lib: $(B)/libnonsmooth.a $(B)/libnonsmooth.so

$(B)/obj/%.o: %.c $(B)/flags
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -c $< -o $@

$(B)/libnonsmooth.a: $(OBJ)
	@rm -f $@
	$(AR) rcs $@ $^

$(B)/libnonsmooth.so: $(OBJ) src/nonsmooth.map
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libnonsmooth.so.$(SOVERSION) \
	    -Wl,--version-script=src/nonsmooth.map -Wl,--no-undefined $(OBJ) -o $@ $(LIBS)

# Changes when the compiler or its flags do, so that objects made otherwise are made anew.
$(B)/flags: FORCE
	@mkdir -p $(@D)
	@echo '$(CC) $(ALL_CFLAGS) $(LDFLAGS)' | cmp -s - $@ || echo '$(CC) $(ALL_CFLAGS) $(LDFLAGS)' > $@
FORCE:

# --- tests of the library: one cmocka program a file -----------------------------------------------------

TEST_SRC := $(wildcard tests/unit/test_*.c tests/property/*.c tests/reference/*.c tests/fault/*.c)
TEST_HELP := $(filter-out tests/unit/test_%.c,$(wildcard tests/unit/*.c))
TEST_BIN := $(TEST_SRC:%.c=$(B)/%)
WRAP := -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

.PHONY: units
units: $(TEST_BIN)

$(B)/obj/tests/%.o: ALL_CFLAGS += -Isrc -Itests/unit

$(TEST_BIN): $(B)/%: $(B)/obj/%.o $(TEST_HELP:%.c=$(B)/obj/%.o) $(B)/libnonsmooth.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) $(WRAP) $^ -o $@ -lcmocka $(LIBS)

.PHONY: all clean
all: lib

clean:
	rm -rf $(B)/obj $(B)/tests $(B)/lib* $(B)/flags

-include $(shell find $(B)/obj -name '*.d' 2>/dev/null)
