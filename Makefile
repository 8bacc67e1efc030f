# Everything a new machine needs is Python (3.10 or later), make and git. `make help` explains itself.
SHELL := /bin/bash
.DEFAULT_GOAL := help

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
DATA ?= rooms
ROOT ?=
GTA_IM ?=
SMPLX ?=
PRESET ?= quick
JOBS ?= 2
SEEDS ?= 1
RUNS ?= runs
EXTRA ?=

data_options = --config configs/data/$(DATA).yaml $(if $(ROOT),--set "data.init_args.root=$(ROOT)" \
	$(if $(SMPLX),--set "data.init_args.smplx_models=$(SMPLX)") \
	$(if $(filter folder,$(DATA)),--set "data.init_args.skeleton=$(ROOT)/skeleton.yaml"))
# Runs that do not compare have folders of their own.
folder = $(RUNS)/$(1)$(if $(filter-out rooms,$(DATA)),-$(DATA))$(if $(filter-out quick,$(PRESET)),-$(PRESET))$(if $(filter-out 1,$(SEEDS)),-seeds)
run = $(BIN)/sag sweep sweeps/$(1).yaml --jobs $(JOBS) $(if $(filter-out 1,$(SEEDS)),--seeds $(SEEDS)) --config configs/presets/$(PRESET).yaml
sweep = $(call pretraining,$(1)) $(call run,$(1)) --out $(call folder,$(1)) $(data_options) $(EXTRA) \
	$(if $(GTA_IM),--pretrained $(call folder,$(1))-pretraining) ; status=$$? ; \
	[ $$status -gt 1 ] && exit $$status ; $(BIN)/sag report $(call folder,$(1)) && exit $$status
# On PROX rows start in what they have learned on GTA-IM with the same 16 joints, where GTA_IM says where that is (paper, 4.1).
pretraining = $(if $(GTA_IM),$(if $(filter-out prox,$(DATA)),$(error GTA_IM is for pre-training: give DATA=prox with it)) \
	$(call run,$(1)) --out $(call folder,$(1))-pretraining --config configs/data/gta_im.yaml --set "data.init_args.root=$(GTA_IM)" \
	--set data.init_args.skeleton=prox_16 $(EXTRA) || exit $$? ;)

.PHONY: help
help: ## Show this help.
	@grep -hE '^[a-z0-9_-]+:.*## ' $(MAKEFILE_LIST) | sort | awk -F ':.*## ' '{printf "  make %-14s %s\n", $$1, $$2}'
	@echo
	@echo "  Options: DATA=rooms|gta_im|prox|folder  ROOT=folder of the data  PRESET=quick|standard|paper  JOBS=2  SEEDS=1  RUNS=runs"
	@echo "  For DATA=prox: SMPLX=folder of SMPL-X's models  GTA_IM=folder of GTA-IM, to pre-train on it"
	@echo "  EXTRA=further options of sag sweep, such as --set model.init_args.critic_steps=3, or of the benchmarks"

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --constraint constraints.txt torch
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	@touch $@

.PHONY: install
install: $(VENV)/installed ## Make the virtual environment with the tested versions.

.PHONY: ablation
ablation: install ## Train and test all 16 combinations of M, D, P, C and lay them beside the paper's Table 1.
	@$(call sweep,ablation)

.PHONY: table1
table1: install ## The six rows of the paper's Table 1.
	@$(call sweep,table1)

.PHONY: table2
table2: install ## The rows of the paper's Table 2: Motion FID of other methods and of SAG.
	@$(call sweep,table2)

.PHONY: table3
table3: install ## The rows of the paper's Table 3: as Table 2, on PROX with DATA=prox ROOT=folder.
	@$(call sweep,table3)

.PHONY: table4
table4: install ## The rows of the paper's Table 4: non-collision, on PROX with DATA=prox ROOT=folder.
	@$(call sweep,table4)

.PHONY: figure7
figure7: install ## The paper's Figure 7: train SAG and Cao et al., then how far trajectories to one end point part.
	@$(call sweep,figure7)
	$(BIN)/sag figure7 $(call folder,figure7) --out $(call folder,figure7)

.PHONY: standard
standard: install ## Motion to look at: the run that ships, a blind row, and the whole in many rooms; two hours.
	$(BIN)/sag sweep sweeps/standard.yaml --jobs $(JOBS) --out $(RUNS)/standard
	$(BIN)/sag fit --config configs/base.yaml --config configs/presets/standard.yaml --config configs/data/many_rooms.yaml \
		--trainer.default_root_dir $(RUNS)/standard/mdpc_many_rooms --ckpt_path last
	$(BIN)/sag test --config $(RUNS)/standard/mdpc_many_rooms/config.fit.yaml --config configs/data/rooms.yaml \
		--ckpt_path $(RUNS)/standard/mdpc_many_rooms/checkpoints/last.ckpt
	$(BIN)/sag report $(RUNS)/standard

.PHONY: recipe
recipe: DATA = other_rooms
recipe: install ## One setting of the recipe changed at a time, on rooms that no table is tested on (docs/recipe.md).
	$(BIN)/sag fit --config configs/base.yaml --config configs/presets/quick.yaml --config configs/scene_encoder.yaml --ckpt_path last
	@$(call sweep,recipe)

.PHONY: pages
pages: install ## Renew the tables of README.md and docs/ from results/.
	$(BIN)/sag report --page README.md
	$(BIN)/sag report --page docs/results.md
	$(BIN)/sag report --page docs/recipe.md
	$(BIN)/sag report --page sag/shipped/mdpc/README.md

.PHONY: preview
preview: install ## Draw windows of the synthetic rooms with their motion into runs/preview.png.
	$(BIN)/sag data rooms --preview runs/preview.png

.PHONY: test
test: install ## Run all tests.
	$(BIN)/python -m pytest -n 2 --dist loadfile

.PHONY: chaos
chaos: install ## Kill a sweep 60 times at random moments, flip bits, fill disks: what is lost must be nothing.
	$(BIN)/python -m pytest tests/test_checkpoints.py tests/methods/test_diverging.py tests/methods/test_resume.py
	$(BIN)/python tests/chaos.py $(EXTRA)

.PHONY: study-chaos
study-chaos: install ## Kill the server of a user study 20 times while raters answer: no acknowledged answer may be lost.
	$(BIN)/python tests/study_chaos.py $(EXTRA)

# The peers of the bench extra, without what they want: in a folder of their own, so that nothing installed changes.
$(VENV)/peers/installed: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --no-deps --upgrade --constraint constraints.txt --target $(VENV)/peers \
		pytorch-fid clean-fid
	@touch $@

.PHONY: bench
bench: install $(VENV)/peers/installed ## Measure the metrics beside their peers; an error when a claim is not met.
	$(BIN)/python -m benchmarks $(EXTRA)

.PHONY: check
check: install ## Lint, check types and keep the floors apart.
	$(BIN)/ruff check sag tests benchmarks
	$(BIN)/ruff format --check sag tests benchmarks
	$(BIN)/mypy
	$(BIN)/lint-imports

.PHONY: format
format: install ## Sort imports and format.
	$(BIN)/ruff check --fix sag tests benchmarks
	$(BIN)/ruff format sag tests benchmarks

.PHONY: clean
clean: ## Remove caches of tools; data, runs and the virtual environment stay.
	rm -rf .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis dist
	find sag tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +
