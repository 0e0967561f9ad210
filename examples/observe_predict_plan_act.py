"""Observe, predict, plan, act: Anne helps Sally, round by round, until Sally has her diamond.

Run it with `python examples/observe_predict_plan_act.py [MODEL]`. In each round

* observe: Anne's belief follows her perceptions automatically;
* predict: the model writes Sally's next program from Anne's belief about Sally's belief; it runs on
  a branch of Anne's belief;
* plan: if Sally would not succeed, the model writes Anne's program from Anne's belief; it runs on
  another branch of the belief;
* act: Anne runs a plan in the real world only if it worked in her belief.
"""

import os
import sys
from dataclasses import dataclass

import beliefnest as bn
from beliefnest.llm import Connection, Model, Sampling, ask_for_program, open_model
from beliefnest.prompts import built_in_template
from beliefnest.skills import skills

WISH = "Get a diamond from a chest."
ROUNDS = 3


@dataclass(frozen=True)
class Round:
    """Prediction and plan of Anne, the expected success of the plan, and the outcome."""

    predicted: str
    sally_would_succeed: bool
    planned: str | None
    would_help: bool
    helped: bool


def ask(model: Model, belief: bn.Simulator, task: str) -> str:
    """Return the program that a model gives for a task, from one belief alone."""
    return ask_for_program(
        belief.noting(model, task=task),
        belief.render(built_in_template("paper"), task=task),
        check=lambda program: None,
        system=belief.render(built_in_template("instructions"), skills=skills()),
        sampling=Sampling(seed=0),
    ).program


def imagine(belief: bn.Simulator, agent: str, program: str, branch: str) -> bool:
    """Run a program on a branch of a belief; return True if Sally has a diamond then."""
    belief.switch(branch)
    try:
        belief.run(agent, program)
        return has_diamond(belief)
    finally:
        belief.switch("follow")


def has_diamond(simulator: bn.Simulator) -> bool:
    """Return True if Sally has a diamond, as far as a simulator knows."""
    return simulator.state.agents["sally"].inventory.get("diamond", 0) > 0


def play_round(nest: bn.Nest, model: Model, number: int) -> Round:
    """Predict, plan and act once; observing is automatic."""
    anne = nest["/anne"]
    predicted = ask(model, nest["/anne/sally"], WISH)
    if imagine(anne, "sally", predicted, f"prediction {number}"):
        return Round(predicted, True, None, False, has_diamond(nest["/"]))
    planned = ask(model, anne, "Help Sally.")
    would_help = imagine(anne, "anne", planned, f"plan {number}")
    if would_help:
        nest["/"].run("anne", planned)
    return Round(predicted, False, planned, would_help, has_diamond(nest["/"]))


def play(model: Model, store: str | None = None) -> list[Round]:
    """Play rounds until Sally has her diamond."""
    rounds: list[Round] = []
    with bn.Nest.open(bn.Scenario.load("help-sally"), store=store) as nest:
        nest.play()
        while len(rounds) < ROUNDS and not has_diamond(nest["/"]):
            rounds.append(play_round(nest, model, len(rounds) + 1))
    return rounds


if __name__ == "__main__":
    name = sys.argv[1] if len(sys.argv) > 1 else "offline"
    for each in play(open_model(name, os.environ, Connection())):
        print(f"Sally would succeed: {each.sally_would_succeed}")
        print(f"Anne's plan would help: {each.would_help}; it did: {each.helped}")
