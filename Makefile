# Makefile - builds, tests, shows and installs nonsmooth.  `make help` lists the targets.
#
# Everything is made in build/.  Sources are found by wildcard: a new file needs no change here.
# For the command line: V=1 (show commands), CC, CFLAGS, LDFLAGS, PREFIX, DESTDIR, NGSPICE (the binary),
# NGSPICE_SRC (a tree to take in place of the source package of the installed ngspice).

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
ifneq ($(findstring /,$(NGSPICE)),)
ifeq ($(filter /% ~%,$(firstword $(NGSPICE))),)
override NGSPICE := $(CURDIR)/$(NGSPICE)# tests run it from other folders
endif
endif
export NGSPICE NGSPICE_SRC
OWN_NGSPICE = $(NGSPICE_SRC)$(filter-out ngspice,$(NGSPICE))# not empty: not the one of the system's package

WARN := -Wall -Wextra -Wpedantic -Wconversion -Werror
LIBS := -llapacke -llapack -lblas -lklu -lm
ALL_CFLAGS = -std=c11 $(CFLAGS) $(WARN) -fPIC -MMD -MP -Iinclude -Isrc

Q := $(if $(V),,@)# make V=1 shows the commands

# For the makes called below: all cores, unless the caller said -j.
PARALLEL = --no-print-directory $(if $(V),,-s) $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell nproc))

.DELETE_ON_ERROR:
.DEFAULT_GOAL := all

.PHONY: all lib cm help
all: lib cm tool ## the library, the code models and nsc-mlcp (the default)

help: ## this list
	@sed -n 's/^\([a-z-]*\):[^#]*## /    make \1|/p' Makefile | awk -F'|' '{printf "%-20s %s\n", $$1, $$2}'

# --- what it needs ---------------------------------------------------------------------------------------

PACKAGES := build-essential clang libclang-rt-dev ngspice libngspice0-dev liblapacke-dev liblapack-dev libblas-dev libopenblas-dev \
    libsuitesparse-dev libcmocka-dev locales gnuplot-nox valgrind bison flex autoconf automake libtool pkgconf
LINT_PACKAGES := clang-format clang-tidy cppcheck shellcheck

.PHONY: deps deps-lint
deps: ## what it needs from Debian, and the source of the installed ngspice
	@codemodels/install-packages.sh $(if $(OWN_NGSPICE),$(filter-out ngspice libngspice0-dev,$(PACKAGES)),$(PACKAGES))
	@codemodels/ngspice-source.sh $(NG)

deps-lint: deps
	@codemodels/install-packages.sh $(LINT_PACKAGES)

$(NG)/stamp:
	@echo "The code models need the source of the installed ngspice: run 'make deps' first." >&2; exit 1

# --- library ---------------------------------------------------------------------------------------------

SRC := $(filter-out src/tool/%,$(wildcard src/*/*.c src/*/*/*.c))
OBJ := $(SRC:%.c=$(B)/obj/%.o)

lib: $(B)/libnonsmooth.a $(B)/libnonsmooth.so

$(B)/obj/%.o: %.c $(B)/flags
	@mkdir -p $(@D)
	@echo "  CC      $@"
	$(Q)$(CC) $(ALL_CFLAGS) -c $< -o $@

$(B)/libnonsmooth.a: $(OBJ)
	@echo "  AR      $@"
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(B)/libnonsmooth.so: $(OBJ) $(B)/exports.map
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libnonsmooth.so.$(SOVERSION) \
	    -Wl,--version-script=$(B)/exports.map -Wl,--no-undefined $(OBJ) -o $@ $(LIBS)

# The shared library shows what the public headers declare, and nothing else.
$(B)/exports.map: $(wildcard include/nonsmooth/*.h)
	@mkdir -p $(@D)
	@{ echo '{ global:'; grep -ohE '\<ns_[a-z0-9_]+\(' $^ | sort -u | tr '(' ';'; echo 'local: *; };'; } > $@

.PHONY: tool
tool: $(B)/nsc-mlcp

$(B)/nsc-mlcp: $(B)/obj/src/tool/nsc_mlcp.o $(B)/libnonsmooth.a
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) $^ -o $@ $(LIBS)

# Changes when the compiler or its flags do, so that objects made otherwise are made anew.
$(B)/flags: FORCE
	@mkdir -p $(@D)
	@echo '$(CC) $(ALL_CFLAGS) $(LDFLAGS)' | cmp -s - $@ || echo '$(CC) $(ALL_CFLAGS) $(LDFLAGS)' > $@
.PHONY: FORCE
FORCE:

# --- code models: ifspec.ifs, cfunc.mod -> (cmpp) -> C; with the bridge, dlmain.c and the library -> .cm ---

CM := $(B)/cm
CMPP := $(NG)/tree/src/xspice/cmpp/cmpp
MODELS := $(patsubst codemodels/%/ifspec.ifs,%,$(wildcard codemodels/*/ifspec.ifs))
BRIDGE := $(wildcard codemodels/bridge/*.c)
BRIDGE_PURE := $(wildcard codemodels/bridge/pure/*.c)# see none of ngspice's headers, and have unit tests
CM_OBJ := $(MODELS:%=$(CM)/%/ifspec.o) $(MODELS:%=$(CM)/%/cfunc.o) $(BRIDGE:%.c=$(B)/obj/%.o) $(BRIDGE_PURE:%.c=$(B)/obj/%.o) \
    $(CM)/dlmain.o $(CM)/dstring.o
CM_LISTS := $(addprefix $(CM)/,cmextrn.h cminfo.h udnextrn.h udninfo.h)
# ngspice's headers and what cmpp makes of ours are not written for our warnings.
# 39 of 39.3; a tree between releases, 46+, counts as the next one.
NG_MAJOR = $(eval NG_MAJOR := $$(shell awk -F'"' '/define PACKAGE_VERSION/ { print int($$$$2) + ($$$$2 ~ /[+]/) }' \
    $(NG)/tree/src/include/ngspice/config.h))$(NG_MAJOR)
# The numbers of ngspice's own device types are their places in a table: -DTYPE_DIO=22 and so on.
NG_TYPES = $(eval NG_TYPES := $$(shell awk '/static_devices\[\]/ { on = 1 } on && /^#|};/ { exit } \
    on && match($$$$0, /get_[a-z0-9]+_info/) { t = substr($$$$0, RSTART + 4, RLENGTH - 9); \
    if (t ~ /^(csw|dio|mos1|mos3|sw|vdmos|vsrc)$$$$/) print "-DTYPE_" toupper(t) "=" n + 0; n++ }' \
    $(NG)/tree/src/spicelib/devices/dev.c))$(NG_TYPES)
NG_INCLUDE = $(NG_BEFORE) -isystem $(NG)/tree/src/include -isystem $(NG)/tree/src -DNGSPICE_MAJOR=$(NG_MAJOR) $(NG_TYPES) \
    $(if $(PULSE_OF),-DPULSE_OF=$(PULSE_OF))
PULSE_OF :=# for make test-versions: the version whose PULSE is expected, in place of the one that it is built for
CM_CFLAGS = -std=gnu11 $(CFLAGS) -w -fPIC -MMD -MP -Iinclude -Icodemodels/bridge -I$(CM) $(NG_INCLUDE)

# LAPACK, BLAS and KLU come from archives where there are some: to load the shared ones takes longer than ngspice's
# whole start.  From SuiteSparse 7 on (Debian 13) they ask for the clock of libgomp.
CM_ARCHIVES := liblapacke.a liblapack_pic.a blas/libblas.a libklu.a libbtf.a libamd.a libcolamd.a libsuitesparseconfig.a
CM_FOUND = $(filter /%,$(foreach archive,$(CM_ARCHIVES),$(shell $(CC) -print-file-name=$(archive))))
CM_LIBS = $(if $(filter $(words $(CM_ARCHIVES)),$(words $(CM_FOUND))),$(CM_FOUND) -lm -Wl$(comma)--as-needed -lgomp,$(LIBS))
comma := ,

cm: $(B)/nonsmooth.cm $(B)/nonsmooth.inc $(B)/nonsmooth_mosfet.inc $(B)/chooser/nonsmooth.cm
.SECONDARY: $(MODELS:%=$(CM)/%/ifspec.c) $(MODELS:%=$(CM)/%/cfunc.c)

CM_LIB ?= $(B)/libnonsmooth.a
$(B)/nonsmooth.cm: $(CM_OBJ) $(CM_LIB) codemodels/nonsmooth.map
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,--version-script=codemodels/nonsmooth.map -Wl,--no-undefined \
	    $(filter %.o %.a,$^) -o $@ $(CM_LIBS)

$(B)/%.inc: codemodels/%.inc
	@mkdir -p $(B)
	@cp $< $@

# What is installed as nonsmooth.cm: takes the nonsmooth-NN.cm beside it that the running ngspice needs.
CHOOSER_OBJ := $(B)/obj/codemodels/chooser/chooser.o $(B)/obj/codemodels/bridge/module_memory.o \
    $(B)/obj/codemodels/bridge/pure/version_text.o
$(B)/obj/codemodels/chooser/%.o: private ALL_CFLAGS += -Icodemodels/bridge

$(B)/chooser/nonsmooth.cm: $(CHOOSER_OBJ) codemodels/nonsmooth.map
	@mkdir -p $(@D)
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,--version-script=codemodels/nonsmooth.map -Wl,--no-undefined \
	    $(CHOOSER_OBJ) -o $@ $(if $(findstring mingw,$(CC)),,-ldl)

$(BRIDGE:%.c=$(B)/obj/%.o): private ALL_CFLAGS += $(NG_INCLUDE) -DNONSMOOTH_VERSION=$(VERSION)
$(BRIDGE:%.c=$(B)/obj/%.o): $(CM)/ngspice

# Changes when another ngspice does, so that what was made for the one before is made anew.
$(CM)/ngspice: $(NG)/stamp FORCE
	@mkdir -p $(@D)
	@echo '$(NG)' | cat - $< | cmp -s - $@ || echo '$(NG)' | cat - $< > $@

$(CM_LISTS) &: codemodels/modpath.lst codemodels/udnpath.lst $(wildcard codemodels/*/ifspec.ifs) $(CM)/ngspice
	@mkdir -p $(CM)
	@echo "  CMPP    $@"
	$(Q)CMPP_IDIR=codemodels CMPP_ODIR=$(CM) $(CMPP) -lst

$(CM)/%/ifspec.c: codemodels/%/ifspec.ifs $(CM)/ngspice
	@mkdir -p $(@D)
	@echo "  CMPP    $@"
	$(Q)CMPP_IDIR=$(<D) CMPP_ODIR=$(@D) $(CMPP) -ifs

$(CM)/%/cfunc.c: codemodels/%/cfunc.mod $(CM)/ngspice
	@mkdir -p $(@D)
	@echo "  CMPP    $@"
	$(Q)CMPP_IDIR=$(<D) CMPP_ODIR=$(@D) $(CMPP) -mod

$(CM)/%.o: $(CM)/%.c $(B)/flags
	@echo "  CC      $@"
	$(Q)$(CC) $(CM_CFLAGS) -c $< -o $@

$(CM)/dlmain.o: $(CM_LISTS) $(B)/flags Makefile
	@echo "  CC      $@"
	$(Q)$(CC) $(CM_CFLAGS) -DCMgetCoreItfPtr=ns_bridge_dlmain_core -c $(NG)/tree/src/xspice/icm/dlmain.c -o $@

$(CM)/dstring.o: $(CM)/ngspice $(B)/flags
	@mkdir -p $(@D)
	@echo "  CC      $@"
	$(Q)$(CC) $(CM_CFLAGS) -c $(NG)/tree/src/misc/dstring.c -o $@

# --- tests of the library: one cmocka program a file -----------------------------------------------------

TEST_SRC := $(wildcard tests/unit/*/test_*.c tests/property/*.c tests/reference/*.c tests/fault/*.c)
TEST_HELP := $(wildcard tests/rig/*.c)
BENCH_OWN := $(filter-out tests/bench/bench_%,$(wildcard tests/bench/*.c))
TEST_BIN := $(TEST_SRC:%.c=$(B)/%)
WRAP := -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

.PHONY: units
units: $(TEST_BIN)

$(B)/obj/tests/%.o: private ALL_CFLAGS += -Itests/rig -Icodemodels/bridge/pure

$(filter $(B)/tests/unit/bridge/%,$(TEST_BIN)): $(BRIDGE_PURE:%.c=$(B)/obj/%.o)

# The circuits of the benchmark and of `make compare`.
$(B)/obj/tests/reference/test_effort.o $(B)/obj/tests/compare/%.o: private ALL_CFLAGS += -Itests/bench -Itests/compare
$(B)/tests/reference/test_effort: $(B)/obj/tests/compare/circuits.o $(BENCH_OWN:%.c=$(B)/obj/%.o)

TEST_LIB ?= $(B)/libnonsmooth.a
$(TEST_BIN): $(B)/%: $(B)/obj/%.o $(TEST_HELP:%.c=$(B)/obj/%.o) $(TEST_LIB)
	@mkdir -p $(@D)
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) $(WRAP) -Wl,--wrap=ns_march_free $^ $(TEST_LIB) -o $@ -lcmocka $(LIBS) -lsuitesparseconfig

# --- test ------------------------------------------------------------------------------------------------

# Warnings were looked at by the plain build; sanitizers and coverage make gcc see ones that are not there.
ASAN := B=build/asan WARN=-w \
    CFLAGS='-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined \
        -fsanitize-recover=address -fno-sanitize-recover=undefined'

# A program that uses libngspice, if there is one of the same version as the program ngspice.
HOST_PROGRAM := $(if $(OWN_NGSPICE),,$(if $(wildcard /usr/include/ngspice/sharedspice.h),$(B)/tests/host/host $(B)/tests/host/session))

$(B)/tests/host/%: tests/host/%.c tests/host/callbacks.h $(B)/flags
	@mkdir -p $(@D)
	@echo "  LINK    $@"
	$(Q)$(CC) -std=c11 -D_POSIX_C_SOURCE=200809L $(CFLAGS) $(WARN) $(LDFLAGS) $< -o $@ -lngspice -lm

.PHONY: host host-program
host-program: $(HOST_PROGRAM)

host: deps ## programs that use libngspice: they get every line that ngspice -b prints, and run, stop, alter, resume, reset
	@$(MAKE) $(PARALLEL) cm host-program
	@tests/host/run.sh

.PHONY: test netlists reference sanitize valgrind tags coverage
test: deps ## everything: unit tests, netlists, both again under sanitizers, one run under valgrind
	@$(MAKE) $(PARALLEL) all units host-program
	@$(MAKE) $(PARALLEL) $(ASAN) cm tool units
	@$(MAKE) $(PARALLEL) $(FUZZ) fuzz-programs
	@tests/run.sh

netlists: deps ## every netlist by the exact engine and by the scheme, with its largest error
	@$(MAKE) $(PARALLEL) cm
	@tests/netlist/run.sh default fine

VERSIONS ?=# folders of ngspices: see below
.PHONY: test-versions
test-versions: deps ## the code models on every ngspice of VERSIONS="FOLDER..." (it says how to get them)
	@[ -n '$(VERSIONS)' ] || { sed -n "s/^# *how: //p" tests/versions/run.sh >&2; exit 2; }
	@$(MAKE) $(PARALLEL) all host-program
	@tests/versions/run.sh $(VERSIONS)

.PHONY: waveforms
waveforms: deps ## circuits with closed forms: what .meas gives of pulses, rings and jumps between coarse time points
	@$(MAKE) $(PARALLEL) cm
	@tests/waveform/run.sh

reference: deps ## circuits and problems of the literature, orders, invariants: what these tests print
	@$(MAKE) $(PARALLEL) units
	@for program in $(B)/tests/reference/* $(B)/tests/property/*; do [ ! -x $$program ] || { \
	    echo "== $$(basename $$program)"; OPENBLAS_NUM_THREADS=1 $$program || exit 1; }; done

sanitize: deps ## only the tests under the address and undefined-behaviour sanitizers
	@$(MAKE) $(PARALLEL) $(ASAN) cm tool units
	@tests/run.sh sanitize

valgrind: deps ## only the run under valgrind
	@$(MAKE) $(PARALLEL) all
	@tests/run.sh valgrind

tags: ## equation tags: every one cited is defined in src/README.md, and the reverse
	@tests/run.sh tags

coverage: deps ## lines of src/ that the tests run, file by file
	@$(MAKE) $(PARALLEL) B=build/coverage WARN=-w CFLAGS='-O0 -g --coverage' units tool
	@tests/coverage.sh build/coverage

# --- benchmarks: one program a file tests/bench/bench_*.c, with the files beside them ---------------------

BENCH_BIN := $(patsubst %.c,$(B)/%,$(wildcard tests/bench/bench_*.c))
BENCH_HELP := $(filter-out %/wrap_alloc.c %/retries.c %/trials.c %/net.c %/passive.c,$(TEST_HELP))# without cmocka

.PHONY: bench bench-programs
bench-programs: $(BENCH_BIN)

$(BENCH_BIN): $(B)/%: $(B)/obj/%.o $(BENCH_OWN:%.c=$(B)/obj/%.o) $(BENCH_HELP:%.c=$(B)/obj/%.o) $(B)/libnonsmooth.a
	@mkdir -p $(@D)
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) $^ -o $@ $(LIBS)

# Siconos is C++; where its packages are (make bench-siconos), the benchmark of circuits runs it too.
SICONOS ?= /usr# where its include/siconos and lib are
SICONOS_PACKAGES := libsiconos-kernel-dev libsiconos-numerics-dev
SICONOS_FLAGS = -std=c++17 -O3 -DNDEBUG -w -Iinclude -Isrc -Itests/rig -Itests/bench \
    $(patsubst %,-isystem $(SICONOS)/include/siconos%,/ /kernel /numerics /externals) \
    $(if $(filter-out /usr,$(SICONOS)),-isystem $(SICONOS)/include)# /usr/include is known, and named again not found

$(B)/siconos: tests/bench/siconos.cpp $(BENCH_OWN:%.c=$(B)/obj/%.o) $(BENCH_HELP:%.c=$(B)/obj/%.o) $(B)/libnonsmooth.a
	@echo "  CXX     $@"
	$(Q)$(CXX) $(SICONOS_FLAGS) $(LDFLAGS) $^ -o $@ -L$(SICONOS)/lib/x86_64-linux-gnu -lsiconos_kernel -lsiconos_numerics $(LIBS)

BENCH ?= full# quick: fewer settings, no large circuit but in two programs, and only the programs that the last table needs
# netlists: nothing but the twenty netlists through ngspice
BENCH_GOALS := build/bench/tests/bench/bench_goals# the last table, from what the others wrote
BENCH_quick = $(foreach name,buck theta sparse cases,build/bench/tests/bench/bench_$(name))
BENCH_netlists = build/bench/tests/bench/bench_cases
BENCH_RUN = $(BENCH_quick) $(filter-out $(BENCH_GOALS) $(BENCH_quick),$(wildcard build/bench/tests/bench/bench_*))
bench: deps ## circuits by every engine, beside ngspice: build/bench/*.csv, *.png (10 minutes; BENCH=quick: 2; BENCH=netlists: 5)
	@case '$(BENCH)' in full|quick|netlists) ;; *) echo 'bench: BENCH=$(BENCH)? full, quick and netlists are there' >&2; exit 2;; esac
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' bench-programs cm \
	    $(if $(wildcard $(SICONOS)/include/siconos/kernel/SiconosKernel.hpp),build/bench/siconos)
	@rm -f build/bench/*.csv build/bench/*.dat build/bench/*.gp build/bench/*.png build/bench/*.svg
	@$(MAKE) --no-print-directory bench-run BENCH=$(BENCH)

.PHONY: bench-run
bench-run:
	@for program in $(or $(BENCH_$(BENCH)),$(BENCH_RUN)); do \
	    echo "== $$(basename $$program)"; OPENBLAS_NUM_THREADS=1 BENCH=$(BENCH) $$program || exit 1; done
	@for script in build/bench/*.gp; do gnuplot $$script || exit 1; done
	@[ '$(BENCH)' != full ] || cp build/bench/precision.svg netlists/precision.svg # the picture that README shows
	@$(if $(filter netlists,$(BENCH)),,$(BENCH_GOALS))

.PHONY: bench-points
bench-points: deps ## the twenty netlists by points="auto" and "grid": rows, CPU time, errors of .meas (BENCH=netlists first, if it never ran)
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' bench-programs cm
	@[ -f build/bench/n_six_pulse.csv ] || BENCH=netlists build/bench/tests/bench/bench_cases
	@build/bench/tests/bench/bench_points

.PHONY: bench-periods
bench-periods: deps ## the twenty netlists over a thousand periods: CPU beside ngspice's best settings at their error (BENCH=netlists first, if it never ran)
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' bench-programs cm
	@[ -f build/bench/n_six_pulse.csv ] || BENCH=netlists build/bench/tests/bench/bench_cases
	@build/bench/tests/bench/bench_periods

.PHONY: bench-siconos
bench-siconos: deps ## the same beside Siconos, whose Debian packages it installs
	@codemodels/install-packages.sh $(SICONOS_PACKAGES)
	@$(MAKE) $(PARALLEL) bench BENCH=$(BENCH)

# --- compare: before and after --------------------------------------------------------------------------------

BASE ?= 1144699# the commit to compare with (rooms: too)
CHECK ?= on# off: the present library without its check of every result (src/verify), which older commits did not have
CIRCUITS ?=# names of those to run, from the first column; none: all

.PHONY: compare
compare: deps ## circuits by the library of commit BASE and by this one: instructions, and whether results are the same
	@$(MAKE) $(PARALLEL) $(B)/libnonsmooth.a
	@CC='$(CC)' CFLAGS='$(CFLAGS)' LIBS='$(LIBS)' CHECK='$(CHECK)' tests/compare/run.sh '$(BASE)' $(CIRCUITS)

.PHONY: check-cost
check-cost: deps ## what judging the engines costs: instructions of each circuit of `make compare` with and without it
	@$(MAKE) $(PARALLEL) $(B)/libnonsmooth.a
	@CC='$(CC)' CFLAGS='$(CFLAGS)' LIBS='$(LIBS)' tests/compare/cost.sh $(CIRCUITS)

# --- stress: what is too long for `make test` -------------------------------------------------------------

STRESS_BIN := $(patsubst %.c,$(B)/%,$(wildcard tests/stress/stress_*.c))
STRESS_MLCP ?= 2000# random problems (P1) of each class
STRESS_SECONDS ?= 600# for circuits; STRESS_SEED, STRESS_COUNT, STRESS_CLASS and others: see tests/stress/README.md
STRESS_OWN := $(filter-out tests/stress/stress_%,$(wildcard tests/stress/*.c))

$(B)/obj/tests/stress/stress_engines.o: private ALL_CFLAGS += -Itests/bench
$(B)/tests/stress/stress_engines: $(BENCH_OWN:%.c=$(B)/obj/%.o)

.PHONY: compare-engines
compare-engines: deps ## what method="auto" costs beside the better engine: benchmark, netlists/, random circuits (STRESS_SEED, STRESS_COUNT)
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' build/bench/tests/stress/stress_engines
	@OPENBLAS_NUM_THREADS=1 build/bench/tests/stress/stress_engines netlists/*.cir

.PHONY: stress stress-programs
stress-programs: $(STRESS_BIN)

$(STRESS_BIN): $(B)/%: $(B)/obj/%.o $(STRESS_OWN:%.c=$(B)/obj/%.o) $(BENCH_HELP:%.c=$(B)/obj/%.o) $(B)/libnonsmooth.a
	@mkdir -p $(@D)
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) $^ -o $@ $(LIBS)

stress: deps ## random problems, random converters and networks: every class, every answer judged (STRESS_SECONDS=600)
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' stress-programs
	@echo "== stress_mlcp"; OPENBLAS_NUM_THREADS=1 build/bench/tests/stress/stress_mlcp $(STRESS_MLCP)
	@echo "== stress_circuits"; OPENBLAS_NUM_THREADS=1 STRESS_SECONDS=$(STRESS_SECONDS) build/bench/tests/stress/stress_circuits

.PHONY: sweep
sweep: deps ## devices from ideal to poor (ron, roff): what each circuit costs beside the ideal one; build/stress/ideality.png
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' stress-programs
	@OPENBLAS_NUM_THREADS=1 build/bench/tests/stress/stress_ideality netlists/*.cir; \
	    status=$$?; gnuplot build/stress/ideality.gp && echo "Picture   build/stress/ideality.png"; exit $$status

.PHONY: compare-ngspice
compare-ngspice: deps $(B)/nonsmooth.cm ## random circuits beside ngspice's own models at 36 settings: which are right within 1 % in less CPU time (STRESS_COUNT=200; STRESS_SEED)
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' build/bench/tests/stress/stress_stock
	@OPENBLAS_NUM_THREADS=1 STRESS_NGSPICE=$(abspath $(B)/nonsmooth.cm) build/bench/tests/stress/stress_stock

STRESS_KINDS ?= 200# circuits of each kind; STRESS_SEED, STRESS_SECONDS
.PHONY: stress-kinds
stress-kinds: deps $(B)/nonsmooth.cm ## circuits that came out wrong once, each varied STRESS_KINDS=200 times in values, size, order, names and steps
	@$(MAKE) $(PARALLEL) B=build/bench CFLAGS='-O3 -DNDEBUG' stress-programs
	@OPENBLAS_NUM_THREADS=1 STRESS_COUNT=$(STRESS_KINDS) STRESS_NGSPICE=$(abspath $(B)/nonsmooth.cm) \
	    build/bench/tests/stress/stress_circuits vary tests/stress/kinds/*.cir

# --- corpus: real netlists, fetched by whoever has them ----------------------------------------------------

CORPUS ?=# a folder with OWNER/NAME/PATH of the netlists that tests/corpus/list names

.PHONY: corpus
corpus: deps ## netlists of public repositories with one line more, beside ngspice's own models (CORPUS=folder; see tests/corpus/README.md)
	@$(MAKE) $(PARALLEL) cm
	@tests/corpus/run.sh '$(CORPUS)'

# --- mutants: would a test notice? ------------------------------------------------------------------------

# All of the library in a shared object that shows everything, so that one changed file needs no other link.
$(B)/libnonsmooth-test.so: $(OBJ)
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libnonsmooth-test.so $(WRAP) $^ -o $@ $(LIBS)

MUTANTS ?= 200# how many
MUTANTS_SEED ?= 1
IN_MUTANTS := B=build/mutants WARN=-w CFLAGS=-O2 TEST_LIB=build/mutants/libnonsmooth-test.so
IN_LINES := B=build/mutants/lines WARN=-w CFLAGS='-O1 -g1 -fno-inline --coverage'

.PHONY: mutants mutants-run
mutants: deps ## random small changes to src/, MUTANTS of them by MUTANTS_SEED: which ones no test notices (an hour)
	@$(MAKE) $(PARALLEL) $(IN_MUTANTS) all units
	@$(MAKE) $(PARALLEL) $(IN_LINES) build/mutants/lines/libnonsmooth-test.so
	@$(MAKE) --no-print-directory $(IN_MUTANTS) mutants-run

mutants-run:
	@CC='$(CC)' CFLAGS='$(ALL_CFLAGS)' LIBS='$(LIBS)' WRAP='$(WRAP)' CM_OBJ='$(CM_OBJ)' CM_LIBS='$(CM_LIBS)' \
	    tests/mutants.sh '$(MUTANTS)' '$(MUTANTS_SEED)'

# --- fuzz: any bytes, under the sanitizers -----------------------------------------------------------------

FUZZ_BIN := $(patsubst %.c,$(B)/%,$(wildcard tests/fuzz/*.c))
FUZZ_SECONDS ?= 3600
FUZZ_TIMEOUT ?= 300# s, for one input
FUZZ := B=build/fuzz CC=clang WARN=-w \
    CFLAGS='-O1 -g -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,address,undefined \
        -fno-sanitize-recover=undefined'

.PHONY: fuzz fuzz-programs
fuzz-programs: $(FUZZ_BIN)

$(FUZZ_BIN): $(B)/%: $(B)/obj/%.o $(B)/libnonsmooth.a
	@mkdir -p $(@D)
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -fsanitize=fuzzer $^ -o $@ $(LIBS)

fuzz: deps ## libFuzzer on the text reader and on random small systems, side by side, FUZZ_SECONDS long (3600)
	@$(MAKE) $(PARALLEL) $(FUZZ) fuzz-programs
	@tests/fuzz.sh $(FUZZ_SECONDS) $(FUZZ_TIMEOUT)

# --- demo ------------------------------------------------------------------------------------------------

.PHONY: demo picture
demo: deps ## a buck converter in the stock ngspice, and its waveforms in build/demo.png
	@$(MAKE) $(PARALLEL) cm
	@netlists/demo.sh build/demo.png

picture: deps # the drawing that README shows
	@$(MAKE) $(PARALLEL) cm
	@netlists/demo.sh netlists/demo.svg

# --- style -----------------------------------------------------------------------------------------------

C_FILES := $(wildcard include/*.h include/*/*.h src/*/*.[ch] src/*/*/*.[ch] codemodels/bridge/*.[ch] codemodels/bridge/*/*.[ch] codemodels/chooser/*.c tests/*/*.[ch] tests/unit/*/*.[ch])
TIDY_FILES := $(filter %.c,$(C_FILES))
TIDY_FLAGS = -std=c11 -Iinclude -Isrc -Itests/rig -Itests/bench -Itests/compare -Icodemodels/bridge -Icodemodels/bridge/pure $(NG_INCLUDE)

.PHONY: lint
lint: deps-lint ## clang-format, clang-tidy, cppcheck, shellcheck, and all of it built by clang and by gcc
	clang-format --dry-run -Werror $(C_FILES)
	@$(MAKE) $(PARALLEL) all units bench-programs stress-programs
	@$(MAKE) $(PARALLEL) CC=clang B=build/clang all units bench-programs stress-programs
	@tests/rooms.sh graph
	@tests/rooms.sh check
	$(CC) -x c++ -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only include/nonsmooth.h
	printf '%s\n' $(TIDY_FILES) | xargs -P$(shell nproc) -n4 \
	    sh -c 'said=$$(clang-tidy --quiet "$$@" -- $(TIDY_FLAGS) 2>&1) || { echo "$$said"; exit 1; }' tidy
	cppcheck --quiet --std=c11 --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
	    --suppress=uninitvar --suppress=objectIndex -Iinclude -Isrc -Itests/rig src tests codemodels
	shellcheck .ci/run codemodels/*.sh tests/*.sh $(wildcard tests/*/*.sh netlists/*.sh)

.PHONY: rooms
rooms: deps ## the rooms of src/: who uses whom, the rules between them, lines, lengths of functions; of commit BASE too
	@$(MAKE) $(PARALLEL) all
	@tests/rooms.sh graph
	@tests/rooms.sh figures '$(BASE)'
	@tests/rooms.sh check

# --- Windows: cross-compiled by MinGW ------------------------------------------------------------------------

MINGW_PACKAGES := gcc-mingw-w64-x86-64-posix gfortran-mingw-w64-x86-64-posix
MINGW_ROUTINES := LAPACKE_dgetrs_work LAPACKE_dgetrf_work LAPACKE_dgesvd LAPACKE_dgeev LAPACKE_dgecon_work# of LAPACK
W := build/mingw
IN_MINGW = B=$(W) CC=x86_64-w64-mingw32-gcc AR=x86_64-w64-mingw32-ar CFLAGS='-O2 -g -D__USE_MINGW_ANSI_STDIO=1 -D__printf__=__gnu_printf__' LDFLAGS=-static-libgcc \
    LIBS='$(W)/numeric/libnumeric.a -lm' WARN='-Wall -Wextra -Wpedantic -Werror -isystem $(W)/numeric/include' CM_ARCHIVES=none.a \
    NG_BEFORE='-isystem $(W)/ngspice'

# Its isfinite() converts to float: -Wconversion is for other compilers.  Windows' own printf() knows no %zu: MinGW's does.
# ngspice's configuration without what only Unix has, as its configure for Windows would leave it.
$(W)/ngspice/ngspice/config.h: $(NG)/stamp
	@mkdir -p $(@D)
	@sed -E '/define HAVE_/{/define HAVE_(STD|STRING_H|MEMORY_H|INTTYPES_H|LIMITS_H|FLOAT_H|MATH_H|CTYPE_H|ISNAN|ISINF|FINITE|LOGB|ERFC|ASINH|DECL_)/!d}' \
	    $(NG)/tree/src/include/ngspice/config.h > $@

.PHONY: mingw mingw-library
mingw: deps ## for Windows, by MinGW: library, nsc-mlcp.exe, code models; nsc-mlcp.exe runs its tests if wine is there
	@codemodels/install-packages.sh $(MINGW_PACKAGES)
	@codemodels/mingw-libraries.sh $(W)/numeric $(MINGW_ROUTINES)
	@$(MAKE) $(PARALLEL) $(W)/ngspice/ngspice/config.h
	@$(MAKE) $(PARALLEL) $(IN_MINGW) mingw-library
	@tests/mingw.sh $(W)

mingw-library: $(B)/libnonsmooth.a $(B)/nonsmooth.dll $(B)/nsc-mlcp $(B)/nonsmooth.cm $(B)/chooser/nonsmooth.cm

$(B)/nonsmooth.dll: $(OBJ) $(B)/exports.map
	@echo "  LINK    $@"
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,--version-script=$(B)/exports.map $(filter %.o,$^) -o $@ $(LIBS)

# --- install ---------------------------------------------------------------------------------------------

TO := '$(DESTDIR)$(PREFIX)'

.PHONY: install
install: all ## into PREFIX (/usr/local), below DESTDIR if given
	install -d $(TO)/bin $(TO)/lib/pkgconfig $(TO)/lib/ngspice $(TO)/include/nonsmooth $(TO)/share/nonsmooth
	install -m 644 $(B)/libnonsmooth.a $(TO)/lib
	install -m 755 $(B)/libnonsmooth.so $(TO)/lib/libnonsmooth.so.$(VERSION)
	ln -sf libnonsmooth.so.$(VERSION) $(TO)/lib/libnonsmooth.so.$(SOVERSION)
	ln -sf libnonsmooth.so.$(SOVERSION) $(TO)/lib/libnonsmooth.so
	install -m 644 include/nonsmooth.h $(TO)/include
	install -m 644 include/nonsmooth/*.h $(TO)/include/nonsmooth
	sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' src/nonsmooth.pc.in > $(TO)/lib/pkgconfig/nonsmooth.pc
	install -m 755 $(B)/nsc-mlcp $(TO)/bin
	install -m 755 $(B)/chooser/nonsmooth.cm $(TO)/lib/ngspice
	install -m 755 $(B)/nonsmooth.cm $(TO)/lib/ngspice/nonsmooth-$(NG_MAJOR).cm
	install -m 644 $(B)/nonsmooth.inc $(B)/nonsmooth_mosfet.inc $(TO)/lib/ngspice
	install -m 644 netlists/lib/nonsmooth.lib $(TO)/share/nonsmooth
	printf '%s\n' "codemodel '$(PREFIX)/lib/ngspice/nonsmooth.cm'" \
	    "setcs sourcepath = ( \$$sourcepath '$(PREFIX)/lib/ngspice' )" > $(TO)/share/nonsmooth/spiceinit
	@if [ -z '$(DESTDIR)' ] && [ -w /etc/ld.so.cache ]; then /sbin/ldconfig; fi # programs find the library now
	@echo "To load the code models in every session: cat '$(PREFIX)/share/nonsmooth/spiceinit' >> ~/.spiceinit"

.PHONY: uninstall
uninstall: ## takes out what install put there, at the same PREFIX and DESTDIR
	rm -f $(addprefix $(TO)/,lib/libnonsmooth.a lib/libnonsmooth.so lib/libnonsmooth.so.$(SOVERSION) \
	    lib/libnonsmooth.so.$(VERSION) include/nonsmooth.h lib/pkgconfig/nonsmooth.pc bin/nsc-mlcp \
	    lib/ngspice/nonsmooth.cm lib/ngspice/nonsmooth.inc lib/ngspice/nonsmooth_mosfet.inc)
	rm -f $(TO)/lib/ngspice/nonsmooth-[0-9]*.cm
	rm -rf $(TO)/include/nonsmooth $(TO)/share/nonsmooth

# --- clean -----------------------------------------------------------------------------------------------

.PHONY: clean distclean
clean: ## removes what was built; the source of ngspice stays, it is slow to get
	@[ ! -d build ] || find build -mindepth 1 -maxdepth 1 ! -name ngspice-src -exec rm -rf {} +

distclean: ## removes build/
	rm -rf build

-include $(shell find $(B)/obj $(CM) -name '*.d' 2>/dev/null)
