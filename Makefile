# The commands of the house. `make run` and `make test` set up everything they need.
BIN := .venv/bin
AGENT ?= basic

.PHONY: run test check format bench docs pages observe clean

run:  ## drive the shuttle route and score the drive
	@scripts/setup run
	@$(BIN)/basu run $(AGENT)

test:  ## all that CI runs: check, then all tests
	@scripts/setup dev
	@scripts/run-tests

check:  ## format, lint, types, import rules, language
	@scripts/setup dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python scripts/check_language.py

format:  ## mend what can be mended by itself
	@scripts/setup dev
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench:  ## the figures of benchmarks/README.md, anew
	@scripts/setup dev
	$(BIN)/python benchmarks/start_up.py
	$(BIN)/python benchmarks/stages.py
	$(BIN)/python benchmarks/ticks.py

docs: pages  ## the documentation site, in site/
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict
	@echo "to read it, with search: $(BIN)/python -m http.server --directory site"

pages:  ## the generated pages and tables of docs/
	@scripts/setup docs
	$(BIN)/python scripts/make_supported.py
	$(BIN)/python scripts/make_scenarios_page.py
	$(BIN)/python scripts/make_options_tables.py
	$(BIN)/python scripts/make_command_line_page.py
	$(BIN)/python scripts/make_agent_page.py
	$(BIN)/python scripts/make_gate_page.py
	$(BIN)/python scripts/make_facts_page.py
	$(BIN)/python scripts/make_fault_page.py
	$(BIN)/python scripts/make_openscenario_page.py
	$(BIN)/python scripts/make_rules_page.py
	$(BIN)/python scripts/make_example_blocks.py

observe:  ## docs/supported.json, from a live server: before `make pages` where the server answers more than before
	@scripts/setup dev
	$(BIN)/python scripts/observe_client.py

clean:
	rm -rf .venv build site packages/*/build packages/*/src/*.egg-info .coverage* .mypy_cache .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -not -path './.git/*' -exec rm -rf {} +
