"""Skills of agent programs: their descriptions, and calls of them."""

from beliefnest.skills.manifests import Parameter, Skill, SkillDetail, skills, skills_at

__all__ = ["Parameter", "Skill", "SkillDetail", "skills", "skills_at"]
