"""Conversion of conversations to Inspect's form."""

from collections.abc import Sequence

from inspect_ai.model import (
    ChatMessage,
    ChatMessageAssistant,
    ChatMessageSystem,
    ChatMessageUser,
)

from beliefnest.llm.messages import Message

__all__ = ["messages_of"]


def messages_of(messages: Sequence[Message]) -> list[ChatMessage]:
    """Convert a conversation to Inspect's form."""
    forms = {
        "system": ChatMessageSystem,
        "user": ChatMessageUser,
        "assistant": ChatMessageAssistant,
    }
    return [forms[each.role](content=each.text) for each in messages]
