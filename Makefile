# Shortcuts for working on BeliefNest, inside an environment with `pip install -e ".[dev]"`.
.PHONY: test nightly check format schema notices picture bench ci

NODE = $(shell python -c 'from beliefnest.bodies.node_files import node_path; print(node_path())')

test:
	pytest

# Every property with many examples, every kill and damage with many seeds: takes hours.
nightly:
	BELIEFNEST_NIGHTLY=1 pytest

check:
	ruff check
	ruff format --check
	mypy
	lint-imports
	cd src/beliefnest/bodies/node && $(NODE) node_modules/eslint/bin/eslint.js .

format:
	ruff format
	ruff check --fix

schema:
	python tools/scenario_schema.py

notices:
	python tools/third_party_notices.py

# The picture of the README, made by the program itself.
picture:
	rm -rf build/picture
	beliefnest run sally-anne --out build/picture
	cp build/picture/picture.png docs/img/sally-anne.png

bench:
	beliefnest bench

ci:
	.ci/run
