# Makefile - builds, tests, shows and installs nonsmooth.  `make help` lists the targets.
#
# Everything is made in build/.  Sources are found by wildcard: a new file needs no change here.
# For the command line: CC, CFLAGS, LDFLAGS, PREFIX, DESTDIR, NGSPICE_SRC (a tree to take in place of the
# source package of the installed ngspice), NGSPICE (the binary).

VERSION := 0.1.0
SOVERSION := 0

ifeq ($(origin CC),default)
CC := gcc
endif
CFLAGS ?= -O2 -g
PREFIX ?= /usr/local
NGSPICE ?= ngspice
B := build# where everything is made; other builds (sanitizers, coverage, clang) set it to a folder below
NG := build/ngspice-src# see codemodels/ngspice-source.sh
export NGSPICE NGSPICE_SRC

WARN := -Wall -Wextra -Wpedantic -Wconversion -Werror
LIBS := -llapacke -llapack -lblas -lm
ALL_CFLAGS = -std=c11 $(CFLAGS) $(WARN) -fPIC -MMD -MP -Iinclude -Isrc

# For the sub-makes below: both cores, unless the caller said -j.
JOBS = $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell nproc))
SUBMAKE = +$(MAKE) --no-print-directory $(JOBS)

.DELETE_ON_ERROR:
.SECONDARY:
.DEFAULT_GOAL := all

.PHONY: all lib cm
all: lib cm

# --- what it needs ---------------------------------------------------------------------------------------

PACKAGES := build-essential ngspice liblapacke-dev libopenblas-dev libsuitesparse-dev libcmocka-dev \
    gnuplot-nox valgrind bison flex autoconf automake libtool
LINT_PACKAGES := clang clang-format clang-tidy cppcheck shellcheck

.PHONY: deps deps-lint
deps:
	@codemodels/install-packages.sh $(if $(NGSPICE_SRC),$(filter-out ngspice,$(PACKAGES)),$(PACKAGES))
	@codemodels/ngspice-source.sh $(NG)

deps-lint: deps
	@codemodels/install-packages.sh $(LINT_PACKAGES)

$(NG)/stamp:
	@echo "The code models need the source of the installed ngspice: run 'make deps' first." >&2; exit 1

# --- library ---------------------------------------------------------------------------------------------

SRC := $(wildcard src/*/*.c)
OBJ := $(SRC:%.c=$(B)/obj/%.o)

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

# --- code models: ifspec.ifs, cfunc.mod -> (cmpp) -> C; with the bridge, dlmain.c and the library -> .cm ---

CM := $(B)/cm
CMPP := $(NG)/tree/src/xspice/cmpp/cmpp
MODELS := $(patsubst codemodels/%/ifspec.ifs,%,$(wildcard codemodels/*/ifspec.ifs))
BRIDGE := $(wildcard codemodels/bridge/*.c)
CM_OBJ := $(MODELS:%=$(CM)/%/ifspec.o) $(MODELS:%=$(CM)/%/cfunc.o) $(BRIDGE:%.c=$(B)/obj/%.o) \
    $(CM)/dlmain.o $(CM)/dstring.o
CM_LISTS := $(addprefix $(CM)/,cmextrn.h cminfo.h udnextrn.h udninfo.h)
# ngspice's headers and what cmpp makes of ours are not written for our warnings.
NG_INCLUDE := -isystem $(NG)/tree/src/include
CM_CFLAGS = -std=gnu11 $(CFLAGS) -w -fPIC -MMD -MP -Iinclude -Icodemodels/bridge -I$(CM) $(NG_INCLUDE)

cm: $(B)/nonsmooth.cm

$(B)/nonsmooth.cm: $(CM_OBJ) $(B)/libnonsmooth.a codemodels/nonsmooth.map
	$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,--version-script=codemodels/nonsmooth.map -Wl,--no-undefined \
	    $(filter %.o %.a,$^) -o $@ $(LIBS)

$(B)/obj/codemodels/%.o: ALL_CFLAGS += $(NG_INCLUDE)
$(BRIDGE:%.c=$(B)/obj/%.o): $(NG)/stamp

$(CM_LISTS) &: codemodels/modpath.lst codemodels/udnpath.lst $(wildcard codemodels/*/ifspec.ifs) $(NG)/stamp
	@mkdir -p $(CM)
	CMPP_IDIR=codemodels CMPP_ODIR=$(CM) $(CMPP) -lst

$(CM)/%/ifspec.c: codemodels/%/ifspec.ifs $(NG)/stamp
	@mkdir -p $(@D)
	CMPP_IDIR=$(<D) CMPP_ODIR=$(@D) $(CMPP) -ifs

$(CM)/%/cfunc.c: codemodels/%/cfunc.mod $(NG)/stamp
	@mkdir -p $(@D)
	CMPP_IDIR=$(<D) CMPP_ODIR=$(@D) $(CMPP) -mod

$(CM)/%.o: $(CM)/%.c $(B)/flags
	$(CC) $(CM_CFLAGS) -c $< -o $@

$(CM)/dlmain.o: $(CM_LISTS) $(B)/flags
	$(CC) $(CM_CFLAGS) -c $(NG)/tree/src/xspice/icm/dlmain.c -o $@

$(CM)/dstring.o: $(NG)/stamp $(B)/flags
	@mkdir -p $(@D)
	$(CC) $(CM_CFLAGS) -c $(NG)/tree/src/misc/dstring.c -o $@

# --- tests of the library: one cmocka program a file -----------------------------------------------------

TEST_SRC := $(wildcard tests/unit/test_*.c tests/property/*.c tests/reference/*.c tests/fault/*.c)
TEST_HELP := $(filter-out tests/unit/test_%.c,$(wildcard tests/unit/*.c))
TEST_BIN := $(TEST_SRC:%.c=$(B)/%)
WRAP := -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

.PHONY: units
units: $(TEST_BIN)

$(B)/obj/tests/%.o: ALL_CFLAGS += -Itests/unit

$(TEST_BIN): $(B)/%: $(B)/obj/%.o $(TEST_HELP:%.c=$(B)/obj/%.o) $(B)/libnonsmooth.a
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) $(LDFLAGS) $(WRAP) $^ -o $@ -lcmocka $(LIBS)

# --- clean -----------------------------------------------------------------------------------------------

.PHONY: clean distclean
clean: # the source of ngspice stays: it is slow to get
	@[ ! -d build ] || find build -mindepth 1 -maxdepth 1 ! -name ngspice-src -exec rm -rf {} +

distclean:
	rm -rf build

-include $(shell find $(B)/obj $(CM) -name '*.d' 2>/dev/null)
