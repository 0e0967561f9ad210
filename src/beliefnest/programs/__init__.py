"""The skills of agent programs: one source for their code and for what a model reads of them."""

from beliefnest.programs.manifests import Parameter, Skill, skills

__all__ = ["Parameter", "Skill", "skills"]
