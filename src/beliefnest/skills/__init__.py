"""Skills of agent programs: their descriptions, and calls of them."""

from beliefnest.skills.manifests import Parameter, Skill, skills

__all__ = ["Parameter", "Skill", "skills"]
