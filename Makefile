# Shortcuts for working on BeliefNest, inside an environment with `pip install -e ".[ci]"`.
.PHONY: help test quick hook faults rest nightly check size format schema outlines notices picture notebooks pages baselines docs links bench ci

help: ## What can be made
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /: /' | column -t -s: -o '  '

NODE = $(shell python -c 'from beliefnest.worlds.minecraft.node_files import node_path; print(node_path())')

test: ## The tests of a day
	pytest

quick: ## The quick tests, in less than a minute
	pytest -m quick

hook: ## Let git run the quick checks and tests before each commit
	git config core.hooksPath tools/hooks

faults: ## Whether the tests of a day find the faults of tests/faults/table.toml; takes half an hour
	python -m tests.faults

rest: ## The tests that CI runs besides: see the marks in CONTRIBUTING.md
	pytest -m ci

nightly: ## All that CI does, with every Python, Ray, and many more examples, kills and damages; takes hours
	BELIEFNEST_NIGHTLY=1 .ci/run

check: ## Linters and type checkers
	ruff check
	python tools/openers.py
	python tools/size.py
	ruff format --check
	mypy
	mypy tools
	lint-imports
	cd src/beliefnest/worlds/minecraft/node && $(NODE) node_modules/eslint/bin/eslint.js .
	cd src/beliefnest && $(NODE) viewer/page/web/node_modules/eslint/bin/eslint.js -c worlds/minecraft/node/eslint.config.js skills/code
	cd src/beliefnest/viewer/page/web && $(NODE) node_modules/eslint/bin/eslint.js .
	cd src/beliefnest/studies/participants/web && $(NODE) ../../../viewer/page/web/node_modules/eslint/bin/eslint.js .

size: ## Lower the figures of tools/size.csv to the lines of code of today
	python tools/size.py --write

format: ## Lay out the code
	ruff format
	ruff check --fix

schema: ## docs/scenario.schema.json from the types
	python tools/scenario_schema.py

outlines: ## Names and descriptions of the built-in scenarios, which `beliefnest list` reads
	python tools/outlines.py

notices: ## THIRD_PARTY_NOTICES.md from what is bundled
	python tools/third_party_notices.py

pages: ## The pictures of docs/page.md, taken in a real browser
	python tools/page_pictures.py

picture: ## The pictures of README and docs, by the program itself
	python tools/pictures.py

notebooks: ## What the notebooks of the docs show, by executing them
	python tools/notebooks.py

baselines: ## docs/tasks.md: all tasks by all baselines, over 50 seeds; takes half an hour
	beliefnest play --baselines --seeds 50 --jobs 2 --page docs/tasks.md

# Without --quiet, which keeps warnings from --strict as well.
docs: ## The documentation site, in build/site; a broken link is an error
	NO_MKDOCS_2_WARNING=1 mkdocs build --strict

links: ## The same, asking the web for every outer link as well
	BELIEFNEST_OUTER_LINKS=true NO_MKDOCS_2_WARNING=1 mkdocs build --strict

bench: ## Measure, beside the figures to reach
	beliefnest bench

ci: ## Everything in a fresh environment, as CI does
	.ci/run
