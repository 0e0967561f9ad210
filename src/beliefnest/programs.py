"""Descriptions of the skills that programs can call."""

from beliefnest.skills import Parameter, Skill, skills

__all__ = ["Parameter", "Skill", "skills"]
