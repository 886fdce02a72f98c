# Two commands for a new checkout: `make demo` and `make test`. Needs Python 3.11 or newer with venv,
# make and git. Everything is installed into .venv and written into demo-out; nothing else is touched.

SHELL := /bin/sh
.DEFAULT_GOAL := help
.PHONY: help demo branches web theorems examples report archive release-check figures docs notebooks test lint check test-slow costs campaign faults reading-list bench coq formal clean

VENV := .venv
BIN := $(VENV)/bin
OUT := demo-out
PICTURES := figures-out
BRANCHES := branches-out
WEBS := web-out
EXAMPLES := examples-out
FORMAL := formal-out
SITE := site-out
ARCHIVE := archive-out
JOBS := 2

# The search runs on the processor also where JAX would find an accelerator.
export JAX_PLATFORMS := cpu
export PIP_DISABLE_PIP_VERSION_CHECK := 1

help:
	@echo "make demo       find and certify bifurcations of Earth-Moon halo orbits, draw them (into $(OUT)/)"
	@echo "make branches   prove whole branches: the theorems on curves and surfaces (into $(BRANCHES)/; half an hour)"
	@echo "make web        families of L1 and L2 joined into a graph that is proved (into $(WEBS)/; goes on where it stopped)"
	@echo "make theorems   statements of docs/theorems, from the certificates of make branches and make web"
	@echo "make examples   example systems from files: found, proved, drawn (into $(EXAMPLES)/; minutes)"
	@echo "make report     every theorem, proved and told: both tables and all branches (into $(BRANCHES)/; forty minutes)"
	@echo "make archive    all certificates of make report and make web with a guide for readers (into $(ARCHIVE)/)"
	@echo "make figures    every picture, with its data and proofs (into $(PICTURES)/; long, goes on where it stopped)"
	@echo "make docs       this project as a site (into $(SITE)/)"
	@echo "make notebooks  run the notebooks, and keep their outputs in them"
	@echo "make test       everything that has to pass: lint, format, types, tests"
	@echo "make check      tests that a change can reach, the nearest first, for a minute"
	@echo "make test-slow  the longer proofs and campaigns, and what make test leaves out"
	@echo "make costs      which tests take so long that make test leaves them to make test-slow"
	@echo "make campaign   10,000 false claims, 2,000 forged certificates, claims told otherwise (campaign.json; hours, goes on where it stopped)"
	@echo "make faults     faults made on purpose, one line each, and which tests notice them (faults.json; hours, goes on where it stopped)"
	@echo "make reading-list CHAPTER=curve   what has to be read to believe a theorem: files in order, lines"
	@echo "make release-check   wheel and sdist, installed empty; commands of README and documents, each run once (hours)"
	@echo "make formal     a certified bifurcation, an initial value problem and a theorem, checked by Coq's kernel (into $(FORMAL)/; ROWS, THEOREMS: others)"
	@echo "make bench      benchmarks; each prints its numbers"
	@echo "make clean      remove $(VENV), $(OUT), $(SITE) and caches"

$(BIN)/python:
	@python=; for name in $(PYTHON) python3.11 python3 python; do \
	  if "$$name" -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then python=$$name; break; fi; \
	done; \
	if [ -z "$$python" ]; then \
	  echo "orbitproof needs Python 3.11 or newer with venv; name it with: make PYTHON=/path/to/python3.11" >&2; exit 2; \
	fi; \
	echo "creating $(VENV) with $$python" >&2; "$$python" -m venv $(VENV)

# Stamps: a second run installs again only if the dependencies changed.
$(VENV)/demo.stamp: pyproject.toml setup.py | $(BIN)/python
	@echo "installing orbitproof with the extras explore and figures (the first time it downloads a few hundred megabytes)" >&2
	@$(BIN)/python -m pip install --editable '.[explore,figures]'
	@touch $@

$(VENV)/dev.stamp: pyproject.toml setup.py | $(BIN)/python
	@echo "installing orbitproof with all extras (the first time it downloads a few hundred megabytes)" >&2
	@$(BIN)/python -m pip install --editable '.[explore,figures,oem,spk,parquet,interactive,cluster,docs,dev]'
	@touch $@ $(VENV)/demo.stamp

$(VENV)/base.stamp: pyproject.toml setup.py | $(BIN)/python
	@echo "installing orbitproof" >&2
	@$(BIN)/python -m pip install --editable .
	@touch $@

$(VENV)/docs.stamp: pyproject.toml setup.py | $(BIN)/python
	@echo "installing orbitproof with the extras explore, figures, oem, spk and docs" >&2
	@$(BIN)/python -m pip install --editable '.[explore,figures,oem,spk,docs]'
	@touch $@ $(VENV)/demo.stamp

# The verifier runs in processes of its own in which the search side cannot be imported: verify/alone comes
# first on their path, and on that of their workers, and refuses its modules by name.
EXPLORE = $(BIN)/orbitproof explore candidates
VERIFY = PYTHONPATH=verify/alone $(BIN)/orbitproof verify
FIGURES = $(BIN)/orbitproof figures

# A command that runs when make is ended keeps what it has and ends too (PPID is make, for the shell of a recipe).
BOUND = export ORBITPROOF_ENDS_WITH=$$PPID;

# The commands are those of docs/examples/README.md: its indented lines.
examples: $(VENV)/demo.stamp
	@mkdir -p $(EXAMPLES) && cp docs/examples/*.py $(EXAMPLES)/
	@cd $(EXAMPLES) && sed -n 's|^    orbitproof|$(abspath $(BIN))/orbitproof|p' ../docs/examples/README.md | \
	  while read -r line; do echo "$$line" >&2; $(BOUND) sh -c "$$line" </dev/null || [ $$? -eq 1 ] || exit 2; done

# Exit code 1 of a step (something not found, not proved) does not stop the ones after it.
demo: $(VENV)/demo.stamp
	@$(BOUND) mkdir -p $(OUT); start=$$(date +%s); failed=0; step() { "$$@" || { code=$$?; [ $$code -eq 1 ] || exit $$code; failed=1; }; }; \
	echo "1/3  search: Earth-Moon L1 halo family and Falkner-Skan family"; \
	step $(EXPLORE) --preset demo -o $(OUT)/candidates.json --family-output $(OUT)/families.json; \
	echo; echo "2/3  proof, in a process that cannot import the search side"; \
	step env $(VERIFY) $(OUT)/candidates.json -o $(OUT)/certificates.json --jobs $(JOBS); \
	echo; echo "3/3  pictures, and tables beside the published values"; \
	$(FIGURES) tables $(OUT)/certificates.json --candidates $(OUT)/candidates.json -o $(OUT)/tables --allow-missing & tables=$$!; \
	step $(FIGURES) family $(OUT)/candidates.json $(OUT)/certificates.json --family $(OUT)/families.json -o $(OUT)/figures; \
	step wait $$tables; \
	echo; echo "certificates: $(OUT)/certificates.json   pictures: $(OUT)/figures/   tables: $(OUT)/tables/"; \
	echo "time: $$(($$(date +%s) - start)) s"; \
	[ $$failed -eq 0 ] || echo "not everything was found or proved: the reasons stand above" >&2; \
	exit $$failed

# Atlas and proof of each branch. What exists is kept, what was interrupted goes on.
# BIFURCATIONS=certificates.json also says which certified bifurcations lie on them.
CURVES := falkner-skan l1-circle-earth-moon l1-circle-sun-jupiter l2-arc-earth-moon l2-arc-sun-jupiter dro-earth-moon
MASSES := earth-moon sun-jupiter
SURFACES := L1 L2 L3

branches: $(VENV)/demo.stamp
	@$(BOUND) mkdir -p $(BRANCHES); failed=0; \
	step() { "$$@" || { code=$$?; [ $$code -eq 1 ] || exit $$code; failed=1; }; }; \
	cover() { file=$(BRANCHES)/$$1.json; shift; [ -e $$file ] || step $(BIN)/orbitproof explore "$$@" -o $$file; }; \
	prove() { \
	  echo; step env $(VERIFY) atlas $(BRANCHES)/$$1.json -o $(BRANCHES)/$$1-certificate.json --jobs $(JOBS) \
	    $(if $(BIFURCATIONS),--bifurcations $(BIFURCATIONS) --only "$$2") $$3; \
	}; \
	surface() { \
	  name=$$1; shift; cover $$name atlas-mass "$$@"; \
	  echo; step env $(VERIFY) atlas $(BRANCHES)/$$name.json -o $(BRANCHES)/$$name-certificate.json --jobs $(JOBS); \
	}; \
	for name in $(CURVES); do \
	  cover $$name atlas --preset $$name; \
	  case $$name in \
	    falkner-skan) only=falkner-skan-*; list="--complete 12";; \
	    dro-*) only=$${name#dro-}-dro-*; list="--complete 4 --lasting";; \
	    *) mass=$${name#*-*-}; point=$$(echo $${name%%-*} | tr l L); only=$$mass-$$point-*; list=;; \
	  esac; \
	  prove $$name "$$only" "$$list"; \
	done; \
	for mass in $(MASSES); do \
	  cover lyapunov-$$mass atlas-libration --point L1 --mass $$mass; prove lyapunov-$$mass "$$mass-L1-*k1-1" "--complete 12"; \
	done; \
	for point in $(SURFACES); do \
	  case $$point in L1) planar=--lyapunov;; *) planar=;; esac; surface mass-$$point --point $$point $$planar; \
	done; \
	for point in L1 L2; do surface axial-mass-$$point --point $$point --family axial; done; \
	step $(FIGURES) atlas $(BRANCHES)/*-certificate.json -o $(BRANCHES)/figures; \
	exit $$failed

# Who proves: processes here, or those of a dask scheduler (SCHEDULER=tcp://..).
WORKERS = $(if $(SCHEDULER),--scheduler $(SCHEDULER),--jobs $(JOBS))

# Planar, halo, axial and vertical families of L1, L2 and L3, butterfly orbits, distant retrograde orbits as graphs (docs/webs).
# What exists is kept, what was interrupted goes on. ARCS="vertical-L1 ..": only these. LISTS=4: with the lists of resonances up to
# 1:4, and where arcs are stable. The index is counted between the points of an arc's list, else at one orbit.
WEB := lyapunov-L1 l1-circle axial-L1 vertical-L1 lyapunov-L2 l2-arc axial-L2 vertical-L2 lyapunov-L3 l3-halo axial-L3 vertical-L3 dro butterfly
ARCS :=
LISTS :=

web: $(VENV)/demo.stamp
	@$(BOUND) mkdir -p $(WEBS); failed=0; rows=$(WEBS)/candidates.json; \
	step() { "$$@" || { code=$$?; [ $$code -eq 1 ] || exit $$code; failed=1; }; }; \
	cover() { [ -e $$atlas ] || step $(BIN)/orbitproof explore "$$@" -o $$atlas; }; \
	is_proved() { grep -q '^ "verdict": "proved"' $$1 2>/dev/null; }; \
	plan() { \
	  missing=; given=; indices=; \
	  for each in $(WEB); do \
	    file=$(WEBS)/$$each-$$mass-certificate.json; given="$$given $$file"; is_proved $$file || missing="$$missing $$each"; \
	    file=$(WEBS)/$$each-$$mass-index.json; ! is_proved $$file || indices="$$indices $$file"; \
	  done; \
	  echo; echo "$$mass: $${missing:+not proved yet:$$missing, }the graph"; \
	}; \
	search() { \
	  done=$(WEBS)/$$1.searched; shift; \
	  [ -e $$done ] || { step $(EXPLORE) "$$@" --jobs $(JOBS) --append -o $$rows; : >$$done; }; \
	}; \
	count() { \
	  if is_proved $$1 && ! { is_proved $$2 && [ $$2 -nt $$1 ]; }; then \
	    step env $(VERIFY) index --curve $$1 -o $$2 --jobs $(JOBS); \
	  fi; \
	}; \
	search halo-and-doublings --preset tables -k 1 2; search axial --preset axial-births -k 1; \
	for mass in $(MASSES); do \
	  search l3-$$mass --family L3-halo --mass $$mass --z-max 0.1 -k 1; \
	  search l3-axial-$$mass --family L3-axial --mass $$mass --max-orbits 40 -k 1; \
	  search dro-$$mass --system cr3bp --family dro --mass $$mass --jacobi-min 2.3 -k 1; \
	done; \
	step env $(VERIFY) $$rows -o $(WEBS)/certificates.json $(WORKERS); \
	step env $(VERIFY) docs/webs/vertical-births.json -o $(WEBS)/vertical-births.json $(WORKERS); \
	for mass in $(MASSES); do \
	  for name in $(or $(ARCS),$(WEB)); do \
	    plan; atlas=$(WEBS)/$$name-$$mass.json; list="$(if $(LISTS),--complete $(LISTS))"; at="--point $${name#*-} --mass $$mass"; \
	    case $$name in \
	      lyapunov-*) \
	        case $$name-$$mass in \
	          *-L1-earth-moon) to="--end -0.09";; *-L2-earth-moon) to="--end -0.15";; \
	          *-L1-sun-jupiter) to="--end -0.04";; *-L2-sun-jupiter) to="--end -0.065";; *-L3-sun-jupiter) to="--through axial --tube 2e-10";; \
	          *-L3-earth-moon) to="--through axial --tube 1e-9";; \
	          *) to="--through axial";; \
	        esac; \
	        cover atlas-libration $$at $$to; case $$name in *-L3) list="$$list --precision 120";; esac;; \
	      vertical-L3) cover atlas-libration $$at --vertical; list=;; \
	      vertical-*) cover atlas-libration $$at --vertical;; \
	      axial-L3) cover atlas-libration $$at --axial; list="--top 2";; \
	      axial-*) cover atlas-libration $$at --axial;; \
	      butterfly) cover atlas --preset $$name-$$mass; list="--precision 128";; \
	      l3-halo) cover atlas --preset $$name-$$mass --coordinates physical; list="--top 2 --precision 96";; \
	      *) cover atlas --preset $$name-$$mass;; \
	    esac; \
	    [ ! -e $$atlas ] || step env $(VERIFY) atlas $$atlas -o $(WEBS)/$$name-$$mass-certificate.json $$list $(WORKERS); \
	    count $(WEBS)/$$name-$$mass-certificate.json $(WEBS)/$$name-$$mass-index.json; \
	  done; \
	  plan; \
	  if [ -n "$$missing" ]; then failed=1; continue; fi; \
	  step env $(VERIFY) web docs/webs/$$mass.json --certificates $$given $$indices $(WEBS)/certificates.json \
	    $(WEBS)/vertical-births.json --indices \
	    -o $(WEBS)/$$mass.json --jobs $(JOBS); \
	  step $(FIGURES) web $(WEBS)/$$mass.json --certificates $$given -o $(WEBS) --page $(WEBS)/$$mass.html; \
	done; \
	exit $$failed

# Everything that is proved here, in one document; points that are refined, atlases and proofs that exist are kept.
report: $(VENV)/demo.stamp
	@$(BOUND) mkdir -p $(BRANCHES); step() { "$$@" || [ $$? -eq 1 ]; }; rows=$(BRANCHES)/candidates.json; \
	step $(EXPLORE) --preset tables --folds --append -o $$rows && step $(EXPLORE) --system falkner-skan -k 2 3 4 --append -o $$rows && \
	step env $(VERIFY) $$rows -o $(BRANCHES)/certificates.json --jobs $(JOBS) || exit 2
	-@$(MAKE) --no-print-directory branches BIFURCATIONS=$(BRANCHES)/certificates.json
	@$(BOUND) $(BIN)/orbitproof report $(BRANCHES)/certificates.json $(BRANCHES)/*-certificate.json \
	  -o $(BRANCHES)/report.html -o $(BRANCHES)/report.tex -o $(BRANCHES)/report.md

# What `make branches`, `make report` and `make web` have proved; run them first for all theorems. FOLDERS: others, of certificates.
FOLDERS = $(wildcard $(BRANCHES) $(WEBS))

theorems: $(VENV)/demo.stamp
	@$(BIN)/python docs/theorems.py $(or $(FOLDERS),$(BRANCHES))

archive: $(VENV)/demo.stamp
	@$(BIN)/python docs/archive.py $(or $(FOLDERS),$(BRANCHES)) -o $(ARCHIVE)

# LIMIT: seconds of processor time for each printed command; what takes longer is stopped, and told.
LIMIT := 600

release-check: $(VENV)/dev.stamp
	@$(BOUND) $(BIN)/python tests/release_check.py --limit $(LIMIT)

# The data are kept by `make clean`: they hold the proofs of all rows.
figures: $(VENV)/demo.stamp
	@$(BOUND) $(BIN)/orbitproof figures data $(PICTURES)/data || [ $$? -eq 1 ]
	@$(BOUND) $(BIN)/orbitproof figures all $(PICTURES)/data -o $(PICTURES)

docs: $(VENV)/docs.stamp
	@$(BIN)/python docs/site/build.py $(SITE)

notebooks: $(VENV)/docs.stamp
	@$(BIN)/python docs/notebooks.py

lint: $(VENV)/dev.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# Tests beside each other share what their module makes once. They start processes by the hundred, which read compiled
# sources if those may be kept. Some wait, for processes or limits of time: three runs of tests keep two cores busy.
PYTEST = PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n 3 --dist worksteal

# Lint has a core to itself only while the tests begin, and is read after them.
test: $(VENV)/dev.stamp
	@said=$$(mktemp) && trap 'rm -f "$$said"' EXIT && trap 'kill $$lint $$tests 2>/dev/null; wait; exit 130' INT TERM; \
	$(MAKE) --no-print-directory lint >"$$said" 2>&1 & lint=$$!; \
	$(PYTEST) & tests=$$!; wait $$tests; tested=$$?; wait $$lint; linted=$$?; cat "$$said"; [ $$tested -eq 0 ] && [ $$linted -eq 0 ]

check: $(VENV)/dev.stamp
	@$(BIN)/python tests/check.py

test-slow: $(VENV)/dev.stamp
	$(PYTEST) -m slow

# Processor seconds that are left to make test, collecting and lint aside.
LEFT := 450
COSTS := .pytest_cache/costs.jsonl

costs: $(VENV)/dev.stamp
	@mkdir -p .pytest_cache && rm -f $(COSTS); $(PYTEST) --costs $(COSTS); tests=$$?; \
	$(BIN)/python tests/heavy.py $(COSTS) --left $(LEFT) && exit $$tests

campaign: $(VENV)/dev.stamp
	@$(BOUND) $(BIN)/python tests/soundness/campaign.py --jobs $(JOBS) --output campaign.json

# SLIPS: faults made by rule, drawn at random, beside those of the table. SAMPLE: so many of all, drawn at random; 0 tries all.
SLIPS := 200
SAMPLE := 0

faults: $(VENV)/dev.stamp
	@$(BIN)/python tests/faults/run.py --jobs $(JOBS) --slow --slips $(SLIPS) --sample $(SAMPLE) --output faults.json

reading-list: $(BIN)/python
	@$(BIN)/python docs/reading_list.py $(CHAPTER)

bench: $(VENV)/dev.stamp
	@for file in tests/benchmarks/bench_*.py; do echo "$$file"; $(BIN)/python $$file || exit 1; done

# CANDIDATES: a file of candidates; ROWS: which of them, by id, with * and ?. What is proved and checked already is kept. Then
# the initial value problem of formal/README.md, and THEOREMS: Doubling, Tripling, Quadrupling.
CANDIDATES := tests/data/known-bifurcations.json
ROWS := falkner-skan-*-k2-*
THEOREMS := Doubling
FORMAL_ROWS = $(foreach row,$(ROWS),'$(row)') --jobs $(JOBS)

coq:
	@command -v coqc >/dev/null || { echo "Coq is missing; on Debian and Ubuntu: apt install coq libcoq-bignums libcoq-coquelicot" >&2; exit 2; }

formal: coq $(VENV)/base.stamp
	@$(BOUND) mkdir -p $(FORMAL); start=$$(date +%s); failed=0; step() { "$$@" || { code=$$?; [ $$code -eq 1 ] || exit $$code; failed=1; }; }; \
	step $(BIN)/orbitproof verify $(CANDIDATES) -o $(FORMAL)/certificates.json --only $(FORMAL_ROWS); \
	step $(BIN)/orbitproof verify --recheck --formal $(FORMAL)/certificates.json -o $(FORMAL) --only $(FORMAL_ROWS); \
	(cd $(FORMAL) && sed -n '/^```python/,/^```/{/^```/!p;}' ../formal/README.md | $(abspath $(BIN))/python -) || exit; \
	step sh formal/solutions/check.sh $(FORMAL)/Lorenz.v $(THEOREMS:%=$(FORMAL)/%.v); echo "time: $$(($$(date +%s) - start)) s"; exit $$failed

clean:
	rm -rf $(VENV) $(OUT) $(SITE) .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
